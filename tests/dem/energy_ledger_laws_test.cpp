// SPDX-License-Identifier: MIT
// The energy ledger and the momenta for each law, with moving walls.
// Only with --all: energy_ledger_test.cpp has one law.
#include <silt/dem/law/composed_law.hpp>
#include <silt/dem/law/linear_friction.hpp>
#include <silt/dem/law/linear_spring_dashpot.hpp>
#include <silt/dem/law/plastic_cohesive.hpp>
#include <silt/dem/law/walton_braun.hpp>

#include "support/ledger.hpp"
#include <gtest/gtest.h>

namespace silt::test::energy_ledger_laws_test {
namespace {

const dem::LinearFriction friction{.tangential_stiffness = 5e5, .friction_angle = 0.4};

TEST(EnergyLedgerOf, CundallStrack) {
  const dem::CundallStrack law{.normal_stiffness = 1e6,
                               .tangential_stiffness = 5e5,
                               .restitution = 0.8,
                               .friction_angle = 0.4};
  expect_to_close_at_moving_walls(law);
  expect_to_keep_momenta(law);
  expect_second_order(law);
}

TEST(EnergyLedgerOf, CundallStrackByIncrements) {
  const dem::CundallStrackIncremental law{.normal_stiffness = 1e6,
                                          .tangential_stiffness = 5e5,
                                          .restitution = 0.8,
                                          .friction_angle = 0.4};
  expect_to_close_at_moving_walls(law);
  expect_to_keep_momenta(law);
}

TEST(EnergyLedgerOf, LinearSpringDashpot) {
  const dem::Law law{dem::LinearSpringDashpot{.normal_stiffness = 1e6, .restitution = 0.8},
                     friction};
  expect_to_close_at_moving_walls(law);
  expect_to_keep_momenta(law);
  expect_second_order(law);
}

TEST(EnergyLedgerOf, WaltonBraun) {
  const dem::Law law{dem::WaltonBraun{.loading_stiffness = 1e6, .restitution = 0.8}, friction};
  expect_to_close_at_moving_walls(law);
  expect_to_keep_momenta(law);
  expect_second_order(law);
}

TEST(EnergyLedgerOf, PlasticCohesive) {
  const dem::Law law{dem::PlasticCohesive{.loading_stiffness = 1e6,
                                          .unloading_stiffness = 4e6,
                                          .cohesive_stiffness = 1e6,
                                          .dashpot = 1},
                     friction};
  expect_to_close_at_moving_walls(law);
  expect_to_keep_momenta(law);
  expect_second_order(law);
}

}  // namespace
}  // namespace silt::test::energy_ledger_laws_test
