// SPDX-License-Identifier: MIT
// Grains with every component that has state: contacts, breakable bonds, a moving wall,
// periodic sides, an inflow, an outflow and an energy ledger.
#pragma once

#include "support/points.hpp"
#include "support/restart.hpp"

#include <silt/dem.hpp>

#include <utility>
#include <vector>

namespace silt::test {

template <int Dim>
class RestartedGrains {
 public:
  /// Grains of two sizes, `along[k]` of them along axis k; every axis except the last is periodic.
  explicit RestartedGrains(std::vector<Index> along) : along_(std::move(along)) {}

  /// A run at its beginning.
  template <class Law, class S>
  auto make(const Law& law, S search) const {
    const dem::Grains<Dim> all = grains();
    dem::Bonds<Dim> bonds({.normal_stiffness = 5e6,
                           .tangential_stiffness = 2e6,
                           .radius_share = 0.5,
                           .tensile_strength = 4e3});
    bonds.bond_all_touching(all, UniformGrid<Dim>{}, {.max_gap = 1e-4});
    const dem::Moving floor{
        dem::Plane<Dim>{},
        dem::Vibration<Dim>{.amplitude = 1e-3 * up(), .frequency = 60}};
    Vec<Dim> pull = -9.81 * up();
    pull[0] = 5;
    Simulation simulation{all, std::move(search),
                          Forces{Gravity<Dim>{pull}, dem::Contacts{law, floor}, bonds},
                          Leapfrog{GlobalDamping{.alpha = 0.5}}};
    const dem::Blend<dem::UniformSizes> pebbles{
        .sizes = {.min_radius = 0.006, .max_radius = 0.012}, .density = 2500};
    dem::EnergyLedger ledger{simulation};
    dem::Inflow<Box<Dim>, dem::UniformSizes> rain{
        slab(height(), height() + 0.1),
        pebbles,
        {.number = 300, .rate = 3000, .velocity = -2 * up(), .every = 0.002}};
    return RunWith{std::move(simulation), dem::Outflow<Box<Dim>>{hole()}, rain, ledger};
  }

  /// Results of the last step, and totals since the beginning.
  template <class Run>
  static std::vector<double> measured(const Run& run) {
    const auto& grains = run.simulation.particles();
    const auto& contacts = run.simulation.interaction().template part<1>();
    const auto& bonds = run.simulation.interaction().template part<2>();
    const auto& [drain, rain, ledger] = run.observers;
    const auto load = contacts.load_on(grains, 0);
    return {double(contacts.size()), contacts.elastic_energy(grains), load.force.sum(),
            double(bonds.broken().in_tension), bonds.elastic_energy(grains),
            drain.mass(), double(rain.number()), ledger.energies().sum(),
            ledger.work().sum(), ledger.losses().sum(), ledger.imbalance(), ledger.added_energy()};
  }

 private:
  static constexpr double spacing = 0.0205;

  static Vec<Dim> up() { return Vec<Dim>::Unit(Dim - 1); }
  double height() const { return double(along_.back()) * spacing; }

  Box<Dim> slab(double lower, double upper) const {
    Box<Dim> box;
    for (int k = 0; k + 1 < Dim; ++k) {
      box.lower[k] = 0;
      box.upper[k] = double(along_[Index(k)]) * spacing;
    }
    box.lower[Dim - 1] = lower;
    box.upper[Dim - 1] = upper;
    return box;
  }
  Box<Dim> hole() const {
    auto hole = slab(0, 0.03);
    hole.upper[0] = 0.05;
    return hole;
  }

  dem::Grains<Dim> grains() const {
    auto box = slab(-1, 2);
    box.periodic.fill(true);
    box.periodic[Dim - 1] = false;
    dem::Grains<Dim> grains(box);
    Random random{.seed = 7};
    const auto any = [&random] { return random.uniform({-1, 1}); };
    Index number = 0;
    for (Vec<Dim> x : lattice(slab(0, height()), spacing)) {
      const bool is_large = number++ % 3 != 0;
      for (int k = 0; k < Dim; ++k) x[k] += 2e-4 * any();
      const Index i = dem::add_grain(
          grains, x, {.radius = is_large ? 0.0102 : 0.007, .density = 2500});
      for (int k = 0; k < Dim; ++k) grains[velocity][i][k] = 0.5 * any();
      grains[velocity][i][0] += 8;  // through many cells, and across the periodic sides
    }
    return grains;
  }

  std::vector<Index> along_;
};

}  // namespace silt::test
