// SPDX-License-Identifier: MIT
#include "openings.hpp"

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/setup/extraction.hpp>
#include <silt/mps/setup/inflow.hpp>
#include <silt/mps/setup/outflow.hpp>
#include <silt/mps/setup/pressure_opening.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include "objects.hpp"
#include <pybind11/pybind11.h>

#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace silt::python {
namespace {

// A flow, as openings see a simulation.
template <class Fluid>
class FlowAtOpenings {
  static constexpr int Dim = Fluid::dimension;

 public:
  struct Settings {
    double spacing, density;
    Vec<Dim> gravity;
    bool surface_pressure;  // is given
  };

  FlowAtOpenings(Fluid& fluid, const FlowBeforeStep<Dim>& flow)
      : fluid_(fluid),
        time_(flow.time),
        settings_{flow.spacing, flow.density, flow.gravity, true} {}

  Fluid& particles() { return fluid_; }
  double time() const { return time_; }
  const FlowAtOpenings& interaction() const { return *this; }
  const Settings& settings() const { return settings_; }

 private:
  Fluid& fluid_;
  double time_;
  Settings settings_;
};

// The numbers of a part of a run, whose transfer() gets an archive.
struct WritesNumbers {
  static constexpr bool reads = false;
  std::vector<double>& numbers;

  template <class Number>
  void operator()(const char*, Number& number) {
    numbers.push_back(double(number));
  }
};
struct ReadsNumbers {
  static constexpr bool reads = true;
  const double* next;

  template <class Number>
  void operator()(const char*, Number& number) {
    number = Number(*next++);
  }
};

template <int Dim>
class Openings final : public AnyOpenings<Dim> {
 public:
  using Any = std::variant<mps::Inflow<Dim>, mps::Extraction<Dim>, mps::Outflow<Dim>,
                           mps::PressureOpening<Dim>>;

  explicit Openings(std::vector<Any> openings) : openings_(std::move(openings)) {}

  Index size() const override { return openings_.size(); }
  std::vector<mps::MovingFaces<Dim>> pistons() const override {
    std::vector<mps::MovingFaces<Dim>> all;
    for_each([&](const auto& opening) {
      if constexpr (requires { opening.piston(); }) all.push_back(opening.piston());
    });
    return all;
  }
  std::function<double(const Vec<Dim>&, double)> surface_pressure() const override {
    std::vector<std::function<double(const Vec<Dim>&, double)>> all;
    for_each([&](const auto& opening) {
      if constexpr (requires { opening.surface_pressure(); }) {
        all.push_back(opening.surface_pressure());
      }
    });
    if (all.empty()) return {};
    return [all](const Vec<Dim>& x, double t) {
      double sum = 0;
      for (const auto& each : all) sum += each(x, t);
      return sum;
    };
  }
  void before_step(mps::Fluid<Dim>& fluid, const FlowBeforeStep<Dim>& flow) override {
    let_pass(fluid, flow);
  }
  void before_step(mps::FluidInMixture<Dim>& fluid, const FlowBeforeStep<Dim>& flow) override {
    let_pass(fluid, flow);
  }
  PassedOpening passed(Index opening) const override {
    return std::visit(
        []<class O>(const O& each) -> PassedOpening {
          if constexpr (std::is_same_v<O, mps::PressureOpening<Dim>>) {
            return {each.number_in(), each.number_out(), each.volume()};
          } else if constexpr (std::is_same_v<O, mps::Inflow<Dim>>) {
            return {each.number(), 0, each.volume()};
          } else {
            return {0, each.number(), -each.volume()};
          }
        },
        openings_[opening]);
  }
  std::vector<double> numbers() const override {
    std::vector<double> all;
    WritesNumbers archive{all};
    for (Any each : openings_) {
      std::visit([&](auto& opening) { opening.transfer(archive); }, each);
    }
    return all;
  }
  void set_numbers(const std::vector<double>& numbers) override {
    ReadsNumbers archive{numbers.data()};
    for (Any& each : openings_) {
      std::visit([&](auto& opening) { opening.transfer(archive); }, each);
    }
  }

 private:
  template <class Fluid>
  void let_pass(Fluid& fluid, const FlowBeforeStep<Dim>& flow) {
    FlowAtOpenings<Fluid> simulation(fluid, flow);
    for (Any& each : openings_) {
      std::visit([&](auto& opening) { opening.before_step(simulation); }, each);
    }
  }
  template <class F>
  void for_each(F&& f) const {
    for (const Any& each : openings_) std::visit(f, each);
  }

  std::vector<Any> openings_;
};

template <int Dim>
std::vector<Face<Dim>> faces_of_opening(const py::handle& object) {
  return faces_from<Dim>(type_of(object) + ": faces", object.attr("faces").cast<Doubles>());
}

template <int Dim>
mps::VelocityOpening<Dim> velocity_opening_of(const py::handle& object, double spacing) {
  return {.faces = faces_of_opening<Dim>(object),
          .velocity = vector<Dim>(object, "velocity"),
          .spacing = spacing,
          .from = number(object, "start"),
          .ramp = number(object, "ramp")};
}

template <int Dim>
typename Openings<Dim>::Any opening_of(const py::handle& object, double spacing) {
  const std::string type = type_of(object);
  if (type == "Inflow") {
    mps::VelocityOpening<Dim> opening = velocity_opening_of<Dim>(object, spacing);
    opening.level = number(object, "level");
    return mps::Inflow<Dim>(opening);
  }
  if (type == "Extraction") {
    return mps::Extraction<Dim>(velocity_opening_of<Dim>(object, spacing));
  }
  if (type == "Outflow") {
    return mps::Outflow<Dim>(
        Box<Dim>{.lower = vector<Dim>(object, "lower"), .upper = vector<Dim>(object, "upper")});
  }
  return mps::PressureOpening<Dim>(
      {.faces = faces_of_opening<Dim>(object),
       .inwards = vector<Dim>(object, "inwards"),
       .spacing = spacing,
       .pressure = mps::HydrostaticPressure{.level = number(object, "level"),
                                            .density = number(object, "density"),
                                            .gravity = number(object, "gravity"),
                                            .at_level = number(object, "at_level")}});
}

}  // namespace

template <int Dim>
std::shared_ptr<AnyOpenings<Dim>> openings_of(const py::list& openings, double spacing) {
  if (openings.empty()) return nullptr;
  std::vector<typename Openings<Dim>::Any> all;
  for (const auto object : openings) all.push_back(opening_of<Dim>(object, spacing));
  return std::make_shared<Openings<Dim>>(std::move(all));
}

template std::shared_ptr<AnyOpenings<2>> openings_of(const py::list&, double);
template std::shared_ptr<AnyOpenings<3>> openings_of(const py::list&, double);

}  // namespace silt::python
