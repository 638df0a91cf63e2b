// SPDX-License-Identifier: MIT
// What every energy ledger must do.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace silt::test {

/// The works of the last step sum to the change of kinetic energy, to 1e-10 of the largest of them,
/// and what the ledger says since its beginning agrees.
template <class Ledger>
void expect_closed(const Ledger& ledger, int step) {
  const double kinetic = ledger.energies().kinetic + ledger.energies().rotational;
  const double largest =
      std::max(ledger.works_of_step().largest(), std::abs(ledger.change_of_step()));
  // Velocities are rounded: energies cannot be known better than to their own last digits.
  ASSERT_LE(std::abs(ledger.imbalance()), std::max(1e-10 * largest, 1e-15 * kinetic)) << step;
}

/// Takes steps of dt; the ledger closes in each.
template <class Sim, class Ledger>
void expect_closing(Sim& sim, Ledger& ledger, int steps, double dt) {
  for (int k = 0; k < steps; ++k) {
    sim.step(dt);
    ledger.after_step(sim);
    expect_closed(ledger, k);
    if (::testing::Test::HasFatalFailure()) return;
  }
  const auto kinetic = [](const auto& energies) { return energies.kinetic + energies.rotational; };
  EXPECT_NEAR(kinetic(ledger.energies()) - kinetic(ledger.beginning()),
              ledger.works().sum() + ledger.outside(), 1e-11 * kinetic(ledger.beginning()));
}

}  // namespace silt::test
