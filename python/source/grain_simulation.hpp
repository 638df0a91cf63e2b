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

template <int Dim, class Law>
auto simulation_of(const GrainSetup<Dim>& setup, const Law& law) {
  if (setup.walls.size() > max_walls) {
    fail("grain_simulation: walls: there are " + std::to_string(setup.walls.size()) +
         ", more than " + std::to_string(max_walls) +
         "; join them in fewer, as a Polyline or a MeshWall");
  }
  std::vector<AnyWall<Dim>> walls = setup.walls;
  walls.resize(max_walls);
  const auto with_walls = [&]<std::size_t... w>(std::index_sequence<w...>) {
    return Simulation{
        grains_of(setup), NeighbourList<Dim>{},
        Forces{Gravity<Dim>{setup.gravity}, dem::Contacts{law, walls[w]...}.with(setup.settings)},
        Leapfrog{GlobalDamping{.alpha = setup.damping}}};
  };
  return with_walls(std::make_index_sequence<max_walls>());
}

template <int Dim, class Law>
using GrainSimulationType =
    decltype(simulation_of(std::declval<const GrainSetup<Dim>&>(), std::declval<const Law&>()));

template <int Dim, class Law>
class GrainSimulation final : public TypedSimulation<GrainSimulationType<Dim, Law>> {
  using Base = TypedSimulation<GrainSimulationType<Dim, Law>>;
  using Base::simulation_;

 public:
  GrainSimulation(const GrainSetup<Dim>& setup, const Law& law)
      : Base(simulation_of(setup, law)),
        wall_count_(setup.walls.size()),
        arguments_{{{"gravity", {setup.gravity.begin(), setup.gravity.end()}},
                    {"damping", {setup.damping}},
                    {"steps_per_contact", {setup.settings.steps_per_contact}},
                    {"max_overlap", {setup.settings.max_overlap}}}} {}

  std::vector<std::pair<std::string, double>> energies() const override {
    const auto state = simulation_.state();
    const auto& grains = state.particles;
    const auto& forces = state.interaction;
    return {{"kinetic", kinetic_energy(grains)},
            {"rotational", rotational_energy(grains)},
            {"potential", potential_energy(grains, forces.template part<0>().acceleration())},
            {"elastic", forces.template part<1>().elastic_energy(grains)}};
  }

  void write_checkpoint(const std::filesystem::path& path) const override {
    silt::write_checkpoint(path, simulation_, arguments_);
  }
  void read_checkpoint(const CheckpointToRead& from) override {
    ArgumentsInFile written = arguments_;
    const auto compare = [&](const Box<Dim>& box) {
      require_same(from.file, written, arguments_);
      require_same(from.file, box, simulation_.particles().box());
    };
    this->read(from, compare, written);
  }

  void set_wall_present(Index wall, bool present) override {
    check_wall(wall);
    simulation_.interaction().template part<1>().set_wall_present(wall, present);
  }
  bool is_wall_present(Index wall) const override {
    check_wall(wall);
    return contacts().is_wall_present(wall);
  }
  Load wall_load(Index wall) const override {
    check_wall(wall);
    return load_of<Dim>(contacts().load_on(simulation_.particles(), wall));
  }

 private:
  const auto& contacts() const { return simulation_.interaction().template part<1>(); }
  void check_wall(Index wall) const {
    if (wall < wall_count_) return;
    fail("Simulation: there is no wall " + std::to_string(wall) + "; there are " +
         std::to_string(wall_count_) + ", numbered from 0 in the order in which they were given");
  }

  Index wall_count_;
  ArgumentsInFile arguments_;
};

template <int Dim, class Law>
std::unique_ptr<AnySimulation> make_grain_simulation(const GrainSetup<Dim>& setup, const Law& law) {
  return std::make_unique<GrainSimulation<Dim, Law>>(setup, law);
}

}  // namespace silt::python
