// SPDX-License-Identifier: MIT
// Simulations of grains for Python, with one contact law for all grains and walls.
#pragma once

#include <silt/core/forces.hpp>
#include <silt/core/simulation.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contacts.hpp>
#include <silt/dem/setup/grains.hpp>
#include <silt/integrate/leapfrog.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/measure/energy.hpp>
#include <silt/search/neighbour_list.hpp>

#include "any_simulation.hpp"
#include "any_wall.hpp"
#include "setup_in_file.hpp"
#include "typed_simulation.hpp"

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace silt::python {

template <int Dim>
dem::Grains<Dim> grains_of(const GrainSetup<Dim>& setup) {
  dem::Grains<Dim> grains(setup.box);
  grains.reserve(setup.positions.size());
  for (Index i = 0; i < setup.positions.size(); ++i) {
    try {
      dem::add_grain(grains, setup.positions.template vector<Dim>(i),
                     {.radius = setup.radii[i], .density = setup.densities[i]});
    } catch (const Error& error) {
      throw error.with_prefix("grain " + std::to_string(i) + ": ");
    }
    grains[velocity][i] = setup.velocities.template vector<Dim>(i);
  }
  return grains;
}

/// Of these grains. `further` forces come last.
template <class Grains, int Dim, class Law, class... Further>
auto simulation_of(Grains grains, const GrainSetup<Dim>& setup, const Law& law,
                   const Further&... further) {
  if (setup.walls.size() > max_walls) {
    fail("grain_simulation: walls: there are " + std::to_string(setup.walls.size()) +
         ", more than " + std::to_string(max_walls) +
         "; join them in fewer, as a Polyline or a MeshWall");
  }
  std::vector<AnyWall<Dim>> walls = setup.walls;
  walls.resize(max_walls);
  const auto with_walls = [&]<std::size_t... w>(std::index_sequence<w...>) {
    return Simulation{std::move(grains), NeighbourList<Dim>{},
                      Forces{Gravity<Dim>{setup.gravity},
                             dem::Contacts{law, walls[w]...}.with(setup.settings), further...},
                      Leapfrog{GlobalDamping{.alpha = setup.damping}}};
  };
  return with_walls(std::make_index_sequence<max_walls>());
}

/// Arguments that the library does not compare in a checkpoint.
template <int Dim>
ArgumentsInFile arguments_in_file(const GrainSetup<Dim>& setup) {
  return {{{"gravity", {setup.gravity.begin(), setup.gravity.end()}},
           {"damping", {setup.damping}},
           {"steps_per_contact", {setup.settings.steps_per_contact}},
           {"max_overlap", {setup.settings.max_overlap}}}};
}

/// Energies and walls of simulation_of(…).
template <int Dim, class Sim>
class GrainsOf : public TypedSimulation<Sim> {
  using Base = TypedSimulation<Sim>;

 protected:
  using Base::simulation;

 public:
  GrainsOf(std::shared_ptr<Sim> shared, const GrainSetup<Dim>& setup)
      : Base(std::move(shared)), wall_count_(setup.walls.size()) {}

  std::vector<std::pair<std::string, double>> energies() const override {
    const auto state = simulation().state();
    const auto& grains = state.particles;
    const auto& forces = state.interaction;
    return {{"kinetic", kinetic_energy(grains)},
            {"rotational", rotational_energy(grains)},
            {"potential", potential_energy(grains, forces.template part<0>().acceleration())},
            {"elastic", forces.template part<1>().elastic_energy(grains)}};
  }

  void set_wall_present(Index wall, bool present) override {
    check_wall(wall);
    simulation().interaction().template part<1>().set_wall_present(wall, present);
  }
  bool is_wall_present(Index wall) const override {
    check_wall(wall);
    return contacts().is_wall_present(wall);
  }
  Load wall_load(Index wall) const override {
    check_wall(wall);
    return load_of<Dim>(contacts().load_on(simulation().particles(), wall));
  }

 private:
  const auto& contacts() const { return simulation().interaction().template part<1>(); }
  void check_wall(Index wall) const {
    if (wall < wall_count_) return;
    fail("Simulation: there is no wall " + std::to_string(wall) + "; there are " +
         std::to_string(wall_count_) + ", numbered from 0 in the order in which they were given");
  }

  Index wall_count_;
};

template <int Dim, class Law>
using GrainSimulationType =
    decltype(simulation_of(std::declval<dem::Grains<Dim>>(), std::declval<const GrainSetup<Dim>&>(),
                           std::declval<const Law&>()));

template <int Dim, class Law>
class GrainSimulation final : public Alone<GrainsOf<Dim, GrainSimulationType<Dim, Law>>>,
                              public MadeFrom<GrainSetup<Dim>> {
  using Sim = GrainSimulationType<Dim, Law>;
  using Base = Alone<GrainsOf<Dim, Sim>>;
  using Base::simulation;

 public:
  GrainSimulation(const GrainSetup<Dim>& setup, const Law& law)
      : Base(std::make_shared<Sim>(simulation_of(grains_of(setup), setup, law)), setup),
        MadeFrom<GrainSetup<Dim>>(setup.without_grains()) {}

  void write_checkpoint(const std::filesystem::path& path) const override {
    silt::write_checkpoint(path, simulation(), arguments_in_file(this->setup()));
  }
  void read_checkpoint(const CheckpointToRead& from) override {
    const ArgumentsInFile present = arguments_in_file(this->setup());
    ArgumentsInFile written = present;
    const auto compare = [&](const Sim& read) {
      require_same(from.file, written, present);
      require_same(from.file, read.particles().box(), simulation().particles().box());
    };
    read_compared(from, simulation(), compare, written);
  }
};

template <int Dim, class Law>
std::unique_ptr<AnySimulation> make_grain_simulation(const GrainSetup<Dim>& setup, const Law& law) {
  return std::make_unique<GrainSimulation<Dim, Law>>(setup, law);
}

}  // namespace silt::python
