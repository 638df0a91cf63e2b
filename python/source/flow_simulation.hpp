// SPDX-License-Identifier: MIT
// Flows of mps::Recommended in tanks, for Python.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/simulation.hpp>
#include <silt/core/types.hpp>
#include <silt/integrate/semi_implicit.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/vtk_walls.hpp>
#include <silt/measure/front.hpp>
#include <silt/measure/wall_gauge.hpp>
#include <silt/measure/wall_group.hpp>
#include <silt/measure/wall_load.hpp>
#include <silt/mps.hpp>
#include <silt/search/uniform_grid.hpp>

#include "any_openings.hpp"
#include "any_simulation.hpp"
#include "body_state.hpp"
#include "empty_tank.hpp"
#include "flow_setup.hpp"
#include "setup_in_file.hpp"
#include "typed_simulation.hpp"

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace silt::python {

/// What the fluid may fill of the box of a tank: an open one goes on above its walls.
template <int Dim>
Box<Dim> room_of(const FlowSetup<Dim>& setup, Box<Dim> box) {
  for (int k = 0; k < Dim; ++k) {
    box.lower[k] = 0;
    if (k + 1 == Dim && !setup.lid) break;
    box.upper[k] = setup.tank[Index(k)];
  }
  return box;
}

template <int Dim>
mps::TankOf<mps::Recommended, Dim> tank_of(const FlowSetup<Dim>& setup) {
  auto made = empty_tank_of("flow_simulation", setup);
  auto& fluid = made.particles;
  const Box<Dim> room = room_of(setup, fluid.box());
  fluid.reserve(setup.positions.size());
  for (Index i = 0; i < setup.positions.size(); ++i) {
    const Vec<Dim> x = setup.positions.template vector<Dim>(i);
    const std::string name = "flow_simulation: position of particle " + std::to_string(i);
    require_finite(name, x);
    if (!room.contains(x)) {
      fail(name + " = " + to_text(x) + " m is outside of the tank, from " + to_text(room.lower) +
           " to " + to_text(room.upper) + " m; move it, or enlarge the tank");
    }
    mps::add_particle(fluid, x, mps::Kind::fluid);
    fluid[velocity][i] = setup.velocities.template vector<Dim>(i);
  }
  return made;
}

/// Of this fluid, between these walls.
template <class Scheme, class Fluid, int Dim>
auto simulation_of(Fluid fluid, const mps::WallsOf<Scheme>& walls, const FlowSetup<Dim>& setup) {
  mps::FlowSettings<Dim, Scheme> settings{.spacing = setup.spacing,
                                          .density = setup.density,
                                          .viscosity = setup.viscosity,
                                          .gravity = setup.gravity,
                                          .speed_scale = setup.speed_scale,
                                          .walls = walls};
  if (setup.openings) settings.surface_pressure = setup.openings->surface_pressure();
  return Simulation{std::move(fluid), UniformGrid<Dim>{}, mps::Flow<Scheme, Dim>{settings},
                    SemiImplicit<>{}};
}

/// What openings do before a step of a flow; null: there are none.
template <int Dim, class Sim>
void let_pass(AnyOpenings<Dim>* openings, Sim& simulation) {
  if (openings == nullptr) return;
  const auto& settings = simulation.interaction().settings();
  openings->before_step(simulation.particles(), {.time = simulation.time(),
                                                 .spacing = settings.spacing,
                                                 .density = settings.density,
                                                 .gravity = settings.gravity});
}

/// Measures, walls and openings of simulation_of(…).
template <int Dim, class Sim>
class FlowOf : public TypedSimulation<Sim> {
  using Base = TypedSimulation<Sim>;

 protected:
  using Base::simulation;

 public:
  FlowOf(std::shared_ptr<Sim> shared, const FlowSetup<Dim>& setup)
      : Base(std::move(shared)),
        spacing_(setup.spacing),
        has_lid_(setup.lid),
        moving_count_(setup.moving_count),
        openings_(setup.openings),
        room_(room_of(setup, std::as_const(*this).simulation().particles().box())),
        account_({.mass = setup.density * std::pow(setup.spacing, Dim), .gravity = setup.gravity}) {
  }

  std::vector<std::pair<std::string, double>> energies() const override {
    const auto energy = account_.of(simulation().particles());
    return {{"kinetic", energy.kinetic}, {"potential", energy.potential}};
  }

  // The search is that of the beginning of the last step, and particles may have been removed
  // since.
  Front front() const override {
    auto water = simulation().particles();
    auto search = simulation().search();
    search.update(water);
    return find_front(water, search, {.spacing = spacing_}, [](Index) { return true; });
  }
  double wall_pressure(const std::vector<double>& point,
                       const std::vector<double>& normal) const override {
    const Vec<Dim> x = to_vector<Dim>("Simulation.wall_pressure: point", point);
    check_on_wall(x);
    return WallGauge<Dim>{x, to_vector<Dim>("Simulation.wall_pressure: normal", normal), spacing_}
        .read(simulation().particles(), mps::pressure);
  }

  Load wall_load(Index wall) const override {
    if (wall >= moving_count_) {
      fail("Simulation.wall_load: there is no moving wall " + std::to_string(wall) +
           " of this flow; there are " + std::to_string(moving_count_) +
           ", numbered from 0 in the order in which they were given");
    }
    return load_on(WallGroup::moving_faces(wall), Vec<Dim>::Zero());
  }
  Index body_count() const override { return walls().number_of_bodies(); }
  std::vector<double> body_state(Index body) const override {
    check_body(body);
    return state_of_body<Dim>(walls().bodies(), body);
  }
  Load body_load(Index body) const override {
    check_body(body);
    // Where the load was found.
    const auto& faces = walls().faces();
    const auto group = static_cast<std::uint32_t>(1 + faces.groups() - body_count() + body);
    const Pose<Dim>& before = faces.step_of(group).before;
    return load_on(WallGroup::body(body), before.x_of(centre_of_body<Dim>(walls().bodies(), body)));
  }
  void write_walls(VtkWalls& frames) const override { frames(simulation()); }
  Index opening_count() const override { return openings_ ? openings_->size() : 0; }
  PassedOpening passed_opening(Index opening) const override { return openings_->passed(opening); }

 private:
  const auto& walls() const { return simulation().interaction().walls(); }
  void check_body(Index body) const {
    if (body < body_count()) return;
    fail("Simulation: there is no body " + std::to_string(body) + "; there are " +
         std::to_string(body_count()) + ", numbered from 0 in the order in which they were given");
  }
  Load load_on(WallGroup group, const Vec<Dim>& about) const {
    return load_of<Dim>(WallLoad<Dim>(group).read(simulation(), about));
  }
  void check_on_wall(const Vec<Dim>& x) const {
    const double near = 1e-6 * spacing_;
    bool is_in_tank = true, is_at_side = false;
    for (int k = 0; k < Dim; ++k) {
      const double to_lower = x[k] - room_.lower[k], to_upper = room_.upper[k] - x[k];
      is_in_tank &= to_lower >= -near && to_upper >= -near;
      is_at_side |= to_lower <= near || (to_upper <= near && (k + 1 < Dim || has_lid_));
    }
    if (is_in_tank && is_at_side) return;
    fail("Simulation.wall_pressure: point = " + to_text(x) + " m is on no wall of the tank, from " +
         to_text(room_.lower) + " to " + to_text(room_.upper) + " m; give a point of a wall");
  }

  double spacing_;
  bool has_lid_;
  Index moving_count_;  // of the walls
  std::shared_ptr<AnyOpenings<Dim>> openings_;
  Box<Dim> room_;  // that the fluid may fill
  mps::EnergyAccount<Dim, double> account_;
};

template <int Dim>
using FlowSimulationType = decltype(simulation_of<mps::Recommended>(
    std::declval<mps::Fluid<Dim>>(), std::declval<const mps::ImageWalls&>(),
    std::declval<const FlowSetup<Dim>&>()));

template <int Dim>
class FlowSimulation final : public Alone<FlowOf<Dim, FlowSimulationType<Dim>>>,
                             public MadeFrom<FlowSetup<Dim>> {
  using Sim = FlowSimulationType<Dim>;
  using Base = Alone<FlowOf<Dim, Sim>>;
  using Base::simulation;

 public:
  explicit FlowSimulation(const FlowSetup<Dim>& setup)
      : Base(made(setup), setup), MadeFrom<FlowSetup<Dim>>(setup.without_fluid()) {}

  // As of a C++ program, with which files can be exchanged.
  void write_checkpoint(const std::filesystem::path& path) const override {
    if (openings()) {
      silt::write_checkpoint(path, simulation(), OpeningsInFile{openings()->numbers()});
    } else {
      silt::write_checkpoint(path, simulation());
    }
  }
  void read_checkpoint(const CheckpointToRead& from) override {
    const auto compare = [&](const Sim& read) {
      require_same(from.file, "on_escape", read.particles().box().on_escape,
                   simulation().particles().box().on_escape);
    };
    if (!openings()) return read_compared(from, simulation(), compare);
    OpeningsInFile state{openings()->numbers()};
    read_compared(from, simulation(), compare, state);
    openings()->set_numbers(state.numbers);
  }

 private:
  static std::shared_ptr<Sim> made(const FlowSetup<Dim>& setup) {
    const auto tank = tank_of(setup);
    return std::make_shared<Sim>(
        simulation_of<mps::Recommended>(tank.particles, tank.walls, setup));
  }
  AnyOpenings<Dim>* openings() const { return this->setup().openings.get(); }
  void before_step() override { let_pass(openings(), simulation()); }
};

template <int Dim>
std::unique_ptr<AnySimulation> make_flow_simulation(const FlowSetup<Dim>& setup) {
  return std::make_unique<FlowSimulation<Dim>>(setup);
}

}  // namespace silt::python
