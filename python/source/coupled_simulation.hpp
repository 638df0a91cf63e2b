// SPDX-License-Identifier: MIT
// Grains in a fluid for Python, with any of its contact and drag laws.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/types.hpp>
#include <silt/coupled/coupled.hpp>
#include <silt/coupled/fluid_forces.hpp>
#include <silt/coupled/grains_in_fluid.hpp>
#include <silt/coupled/make_room.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/mps/scheme/mixture.hpp>

#include "any_coupled.hpp"
#include "any_law.hpp"
#include "flow_simulation.hpp"
#include "grain_simulation.hpp"
#include "setup_in_file.hpp"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace silt::python {

/// `empty`, with the particles of a simulation: their ids, and values of all fields that it has.
template <class P>
P with_particles_of(AnySimulation& from, P empty, const std::string& which) {
  if (from.steps() > 0 || from.time() > 0) {
    fail("Coupled: " + which + " has made " + std::to_string(from.steps()) +
         " steps; join simulations before the first one, made from the positions that particles "
         "have");
  }
  // Places in memory, by id: a simulation may have sorted its particles.
  const auto ids = from.ids();
  std::vector<Index> places(ids.size());
  for (Index i = 0; i < ids.size(); ++i) {
    if (ids[i] < places.size()) {
      places[ids[i]] = i;
      continue;
    }
    fail("Coupled: of " + which +
         ", particles were removed; join the simulation before, and remove "
         "them then");
  }
  empty.reserve(from.size());
  for (Index i = 0; i < from.size(); ++i) empty.add(P::Vec::Zero());
  const auto fields = from.fields();
  std::as_const(empty).for_each_field([&]<class F>(const auto&, F field) {
    const auto has_name = [](const FieldInfo& each) { return each.name == name_of<F>(); };
    if (std::ranges::none_of(fields, has_name)) return;
    const ColumnMemory column = from.column(name_of<F>(), false);
    auto values = empty[field];
    for (Index i = 0; i < column.size; ++i) {
      std::memcpy(static_cast<void*>(&values[i]),
                  column.first + std::ptrdiff_t(places[i]) * column.stride, sizeof values[i]);
    }
  });
  return empty;
}

template <class Setup>
const Setup& setup_of(const AnySimulation& simulation, const std::string& which) {
  const auto* made = dynamic_cast<const MadeFrom<Setup>*>(&simulation);
  if (made != nullptr) return made->setup();
  fail("Coupled: " + which +
       " is a simulation of another kind or dimension, or is in a Coupled; "
       "give one that " +
       (which == "grains" ? "grain_simulation()" : "flow_simulation()") + " made");
}

template <int Dim>
auto grains_in_fluid(AnySimulation& grains, const GrainSetup<Dim>& setup, const Joint& joint) {
  auto made =
      simulation_of(with_particles_of(grains, coupled::GrainsInFluid<Dim>(setup.box), "grains"),
                    setup, AnyLaw(setup.law), coupled::FluidForces{joint.drag, joint.coefficients});
  auto& contacts = made.interaction().template part<1>();
  for (Index wall = 0; wall < setup.walls.size(); ++wall) {
    if (!grains.is_wall_present(wall)) contacts.set_wall_present(wall, false);
  }
  return made;
}

template <int Dim>
auto fluid_around(AnySimulation& fluid, const FlowSetup<Dim>& setup) {
  const auto tank = empty_tank_of("Coupled", setup);
  return simulation_of<mps::InMixture<>>(
      with_particles_of(fluid, mps::FluidInMixture<Dim>(tank.particles.box()), "fluid"), tank.walls,
      setup);
}

template <int Dim>
using GrainsInFluidType =
    decltype(grains_in_fluid(std::declval<AnySimulation&>(), std::declval<const GrainSetup<Dim>&>(),
                             std::declval<const Joint&>()));
template <int Dim>
using FluidAroundType =
    decltype(fluid_around(std::declval<AnySimulation&>(), std::declval<const FlowSetup<Dim>&>()));

/// A part of a CoupledSimulation, which makes its steps. Base is a TypedSimulation.
template <class Base>
class PartOfCoupled final : public Base {
 public:
  using Base::Base;

  double time_step() override { return refuse("time_step"), 0; }
  void step() override { refuse("step"); }
  void step(double) override { refuse("step"); }
  bool run(const Run&, Hooks&) override { return refuse("run"), false; }
  void write_checkpoint(const std::filesystem::path&) const override { refuse("write_checkpoint"); }
  void read_checkpoint(const CheckpointToRead&) override { refuse("read_checkpoint"); }

 private:
  [[noreturn]] static void refuse(const std::string& function) {
    fail("Simulation." + function + ": this simulation is a part of a Coupled; call its " +
         function + "()");
  }
};

template <int Dim>
class CoupledSimulation final : public AnyCoupled {
 public:
  using Both = coupled::Coupled<GrainsInFluidType<Dim>, FluidAroundType<Dim>>;

  CoupledSimulation(std::shared_ptr<Both> both, const GrainSetup<Dim>& grains,
                    std::shared_ptr<AnyOpenings<Dim>> openings)
      : both_(std::move(both)),
        arguments_(arguments_in_file(grains)),
        openings_(std::move(openings)) {}

  int dimension() const override { return Dim; }
  double time() const override { return both_->time(); }
  std::uint64_t steps() const override { return both_->steps(); }
  double last_time_step() const override { return both_->last_time_step(); }

  double time_step() override { return both_->time_step(); }
  void step() override {
    before_step();
    both_->step();
  }
  void step(double dt) override {
    before_step();
    both_->step(dt);
  }
  bool run(const Run& run, Hooks& hooks) override {
    CallsHooks observer{hooks, [this] { before_step(); }};
    return both_->run(run, observer);
  }
  std::vector<std::pair<std::string, double>> energies() const override {
    const coupled::CoupledEnergy energy = both_->energy();
    return {{"kinetic_of_grains", energy.grains.kinetic},
            {"potential_of_grains", energy.grains.potential},
            {"kinetic_of_fluid", energy.fluid.kinetic},
            {"potential_of_fluid", energy.fluid.potential},
            {"lost_by_exchange", energy.lost_by_exchange()},
            {"imbalance", energy.imbalance()}};
  }
  double let_fluid_settle(double tolerance, int max_steps) override {
    return both_->let_fluid_settle({.tolerance = tolerance, .max_steps = max_steps});
  }

  void write_frame(VtkSeries& frames) const override { frames(std::as_const(*both_)); }
  void write_checkpoint(const std::filesystem::path& path) const override {
    silt::write_checkpoint(path, std::as_const(*both_), arguments_, openings_in_file());
  }
  void read_checkpoint(const CheckpointToRead& from) override {
    ArgumentsInFile written = arguments_;
    OpeningsInFile openings = openings_in_file();
    const auto compare = [&](const Both& read) {
      const Both& present = *both_;
      require_same(from.file, written, arguments_);
      require_same(from.file, read.grains().particles().box(), present.grains().particles().box());
      require_same(from.file, "on_escape", read.particles().box().on_escape,
                   present.particles().box().on_escape);
    };
    read_compared(from, *both_, compare, written, openings);
    if (openings_) openings_->set_numbers(openings.numbers);
  }

 private:
  void before_step() { let_pass(openings_.get(), both_->fluid()); }
  OpeningsInFile openings_in_file() const {
    return {openings_ ? openings_->numbers() : std::vector<double>{}};
  }

  std::shared_ptr<Both> both_;
  ArgumentsInFile arguments_;  // of the grains
  std::shared_ptr<AnyOpenings<Dim>> openings_;
};

template <int Dim>
Joined join(AnySimulation& grains, AnySimulation& fluid, const Joint& joint) {
  using Grains = GrainsInFluidType<Dim>;
  using Fluid = FluidAroundType<Dim>;
  using Both = typename CoupledSimulation<Dim>::Both;
  const auto& of_grains = setup_of<GrainSetup<Dim>>(grains, "grains");
  const auto& of_fluid = setup_of<FlowSetup<Dim>>(fluid, "fluid");
  if (Dim == 2 && joint.drag.is_named) {
    fail(
        "Coupled: drag = '" + std::string(drag_laws[joint.drag.place].name) +
        "' is a law of spheres, in 3D; in 2D give None, or β of a linear law in kg/s, per metre of "
        "depth");
  }
  Grains in_fluid = grains_in_fluid(grains, of_grains, joint);
  Fluid around = fluid_around(fluid, of_fluid);
  if (joint.makes_room) {
    coupled::make_room(
        around.particles(), std::as_const(in_fluid).particles(),
        {.spacing = of_fluid.spacing, .radius = around.interaction().settings().radius});
  }
  const auto both = std::make_shared<Both>(std::move(in_fluid), std::move(around));
  return {.both = std::make_unique<CoupledSimulation<Dim>>(both, of_grains, of_fluid.openings),
          .grains = std::make_unique<PartOfCoupled<GrainsOf<Dim, Grains>>>(
              std::shared_ptr<Grains>(both, &both->grains()), of_grains),
          .fluid = std::make_unique<PartOfCoupled<FlowOf<Dim, Fluid>>>(
              std::shared_ptr<Fluid>(both, &both->fluid()), of_fluid)};
}

}  // namespace silt::python
