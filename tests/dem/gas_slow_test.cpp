// SPDX-License-Identifier: MIT
// Leapfrog gains or loses a little energy in every elastic collision, but without a drift.
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace silt::test::gas_slow_test {
namespace {

TEST(UndampedGas, ConservesEnergyOverAMillionCollisions) {
  constexpr Index n = 20;
  constexpr double spacing = 0.024;  // solid fraction 30 %
  auto box = cube<3, double>(0, double(n) * spacing);
  box.periodic.fill(true);
  auto grains = dem::make_grains(lattice(box, spacing), pebble);
  grains.set_box(box);
  const auto v = random_points(grains.size(), cube<3, double>(-1, 1), 11);
  std::copy(v.begin(), v.end(), grains[velocity].begin());
  const dem::CundallStrack law{.normal_stiffness = 1e5};
  Simulation sim{grains, NeighbourList<3>{}, dem::Contacts{law}, Leapfrog{}};

  const auto energy = [&] {
    const auto state = sim.state();
    return energy_of_motion(state.particles) + state.interaction.elastic_energy(state.particles);
  };
  const double each =
      dem::contact_duration({.mass = grains[mass][0] / 2, .stiffness = law.normal_stiffness});
  const double dt = sim.time_step();
  const double before = energy();
  double collisions = 0;
  double farthest = 0;
  while (collisions < 1e6) {
    for (int k = 0; k < 500; ++k) {
      sim.step(dt);
      collisions += double(sim.interaction().size()) * dt / each;
    }
    farthest = std::max(farthest, std::abs(energy() / before - 1));
  }
  std::printf("%.0f collisions in %.0f steps: energy off by %.1e, at most by %.1e\n", collisions,
              double(sim.steps()), std::abs(energy() / before - 1), farthest);
  EXPECT_LT(farthest, 5e-4);
}

}  // namespace
}  // namespace silt::test::gas_slow_test
