// SPDX-License-Identifier: MIT
// Flows of mps::Recommended in tanks, for Python.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/simulation.hpp>
#include <silt/core/types.hpp>
#include <silt/integrate/semi_implicit.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/measure/front.hpp>
#include <silt/measure/wall_gauge.hpp>
#include <silt/mps.hpp>
#include <silt/search/uniform_grid.hpp>

#include "any_simulation.hpp"
#include "setup_in_file.hpp"
#include "typed_simulation.hpp"

#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace silt::python {

template <int Dim>
mps::TankOf<mps::Recommended, Dim> tank_of(const FlowSetup<Dim>& setup) {
  const Vec<Dim> size = to_vector<Dim>("flow_simulation: tank", setup.tank);
  mps::Tank<Dim> tank{.column = {setup.spacing, setup.spacing},
                      .size = {.length = size[0], .height = size[Dim - 1]},
                      .spacing = setup.spacing,
                      .lid = setup.lid,
                      .on_escape = setup.on_escape};
  if constexpr (Dim == 3) tank.size.depth = size[1];
  // Walls and box alone: the fluid is that of Python.
  auto made = mps::make_tank<mps::Recommended, Dim>(tank);
  mps::Fluid<Dim> fluid(made.particles.box());
  Box<Dim> room = fluid.box();
  for (int k = 0; k < Dim; ++k) {
    room.lower[k] = 0;
    if (k + 1 == Dim && !setup.lid) break;
    room.upper[k] = setup.spacing * std::round(size[k] / setup.spacing);
  }
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
  made.particles = std::move(fluid);
  return made;
}

template <int Dim>
auto simulation_of(const FlowSetup<Dim>& setup) {
  const auto tank = tank_of(setup);
  const mps::Flow<mps::Recommended, Dim> water{{.spacing = setup.spacing,
                                                .density = setup.density,
                                                .viscosity = setup.viscosity,
                                                .gravity = setup.gravity,
                                                .speed_scale = setup.speed_scale,
                                                .walls = tank.walls}};
  return Simulation{tank.particles, UniformGrid<Dim>{}, water, SemiImplicit<>{}};
}

template <int Dim>
using FlowSimulationType = decltype(simulation_of(std::declval<const FlowSetup<Dim>&>()));

template <int Dim>
class FlowSimulation final : public TypedSimulation<FlowSimulationType<Dim>> {
  using Base = TypedSimulation<FlowSimulationType<Dim>>;
  using Base::simulation_;

 public:
  explicit FlowSimulation(const FlowSetup<Dim>& setup)
      : Base(simulation_of(setup)),
        spacing_(setup.spacing),
        account_({.mass = setup.density * std::pow(setup.spacing, Dim), .gravity = setup.gravity}) {
  }

  std::vector<std::pair<std::string, double>> energies() const override {
    const auto energy = account_.of(simulation_.particles());
    return {{"kinetic", energy.kinetic}, {"potential", energy.potential}};
  }

  // As of a C++ program, with which files can be exchanged.
  void write_checkpoint(const std::filesystem::path& path) const override {
    silt::write_checkpoint(path, simulation_);
  }
  void read_checkpoint(const CheckpointToRead& from) override {
    this->read(from, [&](const Box<Dim>& box) {
      require_same(from.file, "on_escape", box.on_escape, simulation_.particles().box().on_escape);
    });
  }

  // The search is that of the beginning of the last step, and particles may have been removed
  // since.
  Front front() const override {
    auto water = simulation_.particles();
    auto search = simulation_.search();
    search.update(water);
    return find_front(water, search, {.spacing = spacing_}, [](Index) { return true; });
  }
  double wall_pressure(const std::vector<double>& point,
                       const std::vector<double>& normal) const override {
    return WallGauge<Dim>{to_vector<Dim>("Simulation.wall_pressure: point", point),
                          to_vector<Dim>("Simulation.wall_pressure: normal", normal), spacing_}
        .read(simulation_.particles(), mps::pressure);
  }

 private:
  double spacing_;
  mps::EnergyAccount<Dim, double> account_;
};

template <int Dim>
std::unique_ptr<AnySimulation> make_flow_simulation(const FlowSetup<Dim>& setup) {
  return std::make_unique<FlowSimulation<Dim>>(setup);
}

}  // namespace silt::python
