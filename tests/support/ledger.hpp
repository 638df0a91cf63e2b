// SPDX-License-Identifier: MIT
// Checks of the energy ledger for any contact law.
#pragma once

#include "support/grains.hpp"

#include <silt/dem/measure/energy_ledger.hpp>
#include <silt/dem/wall/moving.hpp>
#include <silt/measure/energy.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace silt::test {

/// The sum of all work in the last step equals the change of kinetic energy, to 1e-10 of the
/// largest term.
template <class Ledger>
void expect_closed(const Ledger& ledger, int step) {
  const double kinetic = ledger.energies().kinetic + ledger.energies().rotational;
  const double largest =
      std::max(ledger.work_of_step().max_term(), std::abs(ledger.energy_change_of_step()));
  // Rounding of the velocities limits the accuracy of the energies.
  ASSERT_LE(std::abs(ledger.imbalance()), std::max(1e-10 * largest, 1e-15 * kinetic)) << step;
}

/// Takes steps of dt; the ledger closes in each step and in total.
template <class Sim, class Ledger>
void expect_closing(Sim& sim, Ledger& ledger, int steps, double dt) {
  for (int k = 0; k < steps; ++k) {
    sim.step(dt);
    ledger.after_step(sim);
    expect_closed(ledger, k);
    if (::testing::Test::HasFatalFailure()) return;
  }
  const auto kinetic = [](const auto& energies) { return energies.kinetic + energies.rotational; };
  EXPECT_NEAR(kinetic(ledger.energies()) - kinetic(ledger.initial_energies()),
              ledger.work().sum() + ledger.added_energy(), 1e-11 * kinetic(ledger.energies()));
}

/// Parameters of one simulation for all checks of a law, because each type takes seconds to
/// compile: gravity, global damping, a vibrating floor and a rotating wall.
struct Shaken {
  double gravity = 0;
  double damping = 0;
  double floor = -1e3;
  double shaking = 0;
  double turning = 0;
};
template <class Law>
auto shaken(const dem::Grains<3>& grains, const Law& law, const Shaken& how) {
  const dem::Moving floor{dem::Plane<3>{.point = {0, 0, how.floor}},
                          dem::Vibration<3>{.amplitude = {0, 0, how.shaking}, .frequency = 80}};
  const dem::Moving wall{dem::Plane<3>{.point = {how.floor, 0, 0}, .normal = {1, 0, 0}},
                         dem::Rotation<3>{.spin = {0, 0, how.turning}}};
  return Simulation{grains, BruteForce<3>{},
                    Forces{Gravity<3>{{0, 0, -how.gravity}}, dem::Contacts{law, floor, wall}},
                    Leapfrog{GlobalDamping{.alpha = how.damping}}};
}

/// The ledger closes to 1e-10 for grains with gravity, damping and moving walls.
template <class Law>
void expect_to_close_at_moving_walls(const Law& law) {
  auto sim = shaken(crowd<3, double>(3, 5), law,
                    {.gravity = 9.81, .damping = 1, .floor = 0, .shaking = 2e-3, .turning = 3});
  dem::EnergyLedger ledger{sim};
  expect_closing(sim, ledger, 600, 2e-5);
  EXPECT_NE(ledger.work().walls, 0);
  EXPECT_LT(ledger.work().damping, 0);
  const auto& lost = ledger.losses();
  for (const double loss : {lost.friction, lost.rolling_friction, lost.plastic, lost.separation}) {
    EXPECT_GE(loss, 0);
  }
}

/// Momentum and total angular momentum are conserved for grains without walls.
template <class Law>
void expect_to_keep_momenta(const Law& law) {
  const auto grains = crowd<3, double>(3, 6);
  auto sim = shaken(grains, law, {});
  const Vec<3> about(0.1, -0.2, 0.3);
  const Vec<3> p = silt::momentum(grains);
  const Vec<3> L = silt::angular_momentum(grains, about);
  for (int k = 0; k < 500; ++k) sim.step(2e-5);
  const double mass_of_all = double(grains.size()) * grains[mass][0];
  EXPECT_LT((silt::momentum(sim.particles()) - p).norm(), 1e-13 * mass_of_all);
  EXPECT_LT((silt::angular_momentum(sim.particles(), about) - L).norm(), 1e-13 * mass_of_all);
}

/// Root mean square of the integration error of impacts in which contact and sliding begin at
/// different times within a step.
template <class Law>
double integration_error(const Law& law, double dt) {
  constexpr int impacts = 24;
  double sum = 0;
  for (int k = 0; k < impacts; ++k) {
    const double gap = 1e-5 + 1.5 * dt * k / impacts;
    const double along = 0.3 + 0.013 * (k * 5 % impacts);
    auto grains = two_grains<3>(gap, Vec<3>(-1.5, along, 0));
    grains[spin][1] = {0, 20, 10};
    auto sim = shaken(grains, law, {});
    dem::EnergyLedger ledger{sim};
    do {
      sim.step(dt);
      ledger.after_step(sim);
    } while (sim.interaction().template part<1>().size() > 0 || sim.time() < 2e-4);
    sum += squared(ledger.integration_error());
  }
  return std::sqrt(sum / impacts);
}

/// The integration error is proportional to the square of the time step.
template <class Law>
void expect_second_order(const Law& law) {
  const double coarse = integration_error(law, 2e-5);
  const double fine = integration_error(law, 2.5e-6);
  EXPECT_NEAR(std::log(coarse / fine) / std::log(8), 2, 0.25) << coarse << " J, " << fine << " J";
}

}  // namespace silt::test
