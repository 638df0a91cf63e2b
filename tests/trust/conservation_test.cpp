// SPDX-License-Identifier: MIT
// Long runs conserve momentum, angular momentum and, without losses, energy; with friction or
// damping they never gain energy, by any law. A million collisions: dem/gas_slow_test.cpp.
// Only with --all: long runs with many laws; dem/conservation_test.cpp has short ones.
#include <silt/dem.hpp>
#include <silt/dem/wall/box_wall.hpp>

#include "support/any_law.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace silt::test::conservation_test {
namespace {

constexpr double spacing = 0.024;  // solid fraction 30 %

// Grains without overlaps in a box, with random velocities and, if any, spins.
dem::Grains<3> gas(Index along, double max_spin, unsigned seed) {
  const auto box = cube<3, double>(0, double(along) * spacing);
  auto grains = dem::make_grains(lattice(box, spacing), pebble);
  const auto v = random_points(grains.size(), cube<3, double>(-1, 1), seed);
  const auto w = random_points(grains.size(), cube<3, double>(-1, 1), seed + 1);
  for (Index i = 0; i < grains.size(); ++i) {
    grains[velocity][i] = v[i];
    grains[spin][i] = max_spin * w[i];
  }
  return grains;
}

Box<3> periodic_box(Index along) {
  auto box = cube<3, double>(0, double(along) * spacing);
  box.periodic.fill(true);
  return box;
}

// Kinetic and elastic energy [J].
template <class Sim>
double energy_of(const Sim& sim) {
  const auto state = sim.state();
  return energy_of_motion(state.particles) + state.interaction.elastic_energy(state.particles);
}

TEST(Gas, KeepsItsMomentaByEveryLaw) {
  const Vec<3> about(0.1, -0.2, 0.3);
  for (const auto& [name, law] : all_laws<3>()) {
    // Dense, so that all collide, then in empty space.
    const auto grains = crowd<3, double>(4, 8);
    Simulation sim{grains, NeighbourList<3>{}, dem::Contacts{law}, Leapfrog{}};
    const Vec<3> p = momentum(grains);
    const Vec<3> L = angular_momentum(grains, about);
    double sum_p = 0, sum_L = 0;
    for (Index i = 0; i < grains.size(); ++i) {
      const double m = grains[mass][i];
      sum_p += m * grains[velocity][i].norm();
      sum_L += m * (grains[position][i] - about).norm() * grains[velocity][i].norm() +
               grains[inertia][i] * grains[spin][i].norm();
    }
    const double before = energy_of_motion(grains);
    for (int k = 0; k < 600; ++k) {
      sim.step(2e-5);
      if (k % 50 != 0) continue;
      EXPECT_LE((momentum(sim.particles()) - p).norm(), 1e-14 * sum_p) << name;
      EXPECT_LE((angular_momentum(sim.particles(), about) - L).norm(), 1e-12 * sum_L) << name;
    }
    EXPECT_GT(std::abs(energy_of_motion(sim.particles()) / before - 1), 0.01)
        << name << ": they collided";
  }
}

TEST(Gas, KeepsItsMomentumAcrossPeriodicSides) {
  for (const auto& [name, law] : all_laws<3>()) {
    auto grains = gas(4, 50, 3);
    grains.set_box(periodic_box(4));
    Simulation sim{grains, NeighbourList<3>{}, dem::Contacts{law}, Leapfrog{}};
    const Vec<3> p = momentum(grains);
    double sum_p = 0;
    for (Index i = 0; i < grains.size(); ++i) {
      sum_p += grains[mass][i] * grains[velocity][i].norm();
    }
    for (int k = 0; k < 1000; ++k) sim.step(2e-5);
    EXPECT_LE((momentum(sim.particles()) - p).norm(), 1e-14 * sum_p) << name;
  }
}

TEST(ElasticGas, ConservesItsEnergyOverTenThousandCollisions) {
  constexpr Index along = 6;
  auto grains = gas(along, 0, 11);
  grains.set_box(periodic_box(along));
  const dem::CundallStrack law{.normal_stiffness = 1e4};
  Simulation sim{grains, NeighbourList<3>{}, dem::Contacts{law}, Leapfrog{}};
  const double each =
      dem::contact_duration({.mass = grains[mass][0] / 2, .stiffness = law.normal_stiffness});
  const double dt = sim.time_step();
  const double before = energy_of(sim);
  double collisions = 0;
  double farthest = 0;
  while (collisions < 1e4) {
    for (int k = 0; k < 100; ++k) {
      sim.step(dt);
      collisions += double(sim.interaction().size()) * dt / each;
    }
    farthest = std::max(farthest, std::abs(energy_of(sim) / before - 1));
  }
  EXPECT_LT(farthest, 5e-4) << sim.steps() << " steps";
}

// The largest rise of the energy above an earlier value, over the initial one.
template <class Sim>
double largest_gain(Sim& sim, Index steps, double time_step) {
  const double before = energy_of(sim);
  double lowest = before;
  double gain = 0;
  for (Index k = 0; k < steps; ++k) {
    sim.step(time_step);
    if (k % 10 != 0) continue;
    const double energy = energy_of(sim);
    gain = std::max(gain, (energy - lowest) / before);
    lowest = std::min(lowest, energy);
  }
  EXPECT_LT(lowest, 0.9 * before) << "energy was lost";
  return gain;
}

TEST(LossyGas, NeverGainsEnergyByAnyLaw) {
  for (const auto& [name, law] : all_laws<3>()) {
    // This form creates energy when a sheared contact is compressed, as it says.
    if (name == "Hertz and Mindlin by displacement") continue;
    auto grains = gas(4, 100, 5);
    grains.set_box(periodic_box(4));
    Simulation sim{grains, NeighbourList<3>{}, dem::Contacts{law}, Leapfrog{}};
    EXPECT_LT(largest_gain(sim, 3000, 1e-5), 1e-4) << name;
  }
}

TEST(LossyGas, NeverGainsEnergyBetweenWalls) {
  for (const auto& [name, law] : all_laws<3>()) {
    if (name == "Hertz and Mindlin by displacement") continue;
    const dem::BoxWall<3> walls{.box = cube<3, double>(0, 3 * spacing)};
    Simulation sim{gas(3, 100, 7), NeighbourList<3>{}, dem::Contacts{law, walls},
                   Leapfrog{GlobalDamping{.alpha = 0.5}}};
    EXPECT_LT(largest_gain(sim, 3000, 1e-5), 1e-4) << name;
  }
}

}  // namespace
}  // namespace silt::test::conservation_test
