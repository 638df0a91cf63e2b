// SPDX-License-Identifier: MIT
// The energy ledger for Hertz, Mindlin, rolling resistance and adhesion, with moving walls.
// Only with --all: energy_ledger_test.cpp has one law.
#include <silt/dem/law/adhesion.hpp>
#include <silt/dem/law/capillary_bridge.hpp>
#include <silt/dem/law/composed_law.hpp>
#include <silt/dem/law/hertz.hpp>
#include <silt/dem/law/jkr.hpp>
#include <silt/dem/law/linear_friction.hpp>
#include <silt/dem/law/linear_spring_dashpot.hpp>
#include <silt/dem/law/mindlin.hpp>
#include <silt/dem/law/mindlin_deresiewicz.hpp>
#include <silt/dem/law/rolling_resistance.hpp>

#include "support/ledger.hpp"
#include <gtest/gtest.h>

namespace silt::test::energy_ledger_parts_test {
namespace {

constexpr dem::Elastic soft{.young_modulus = 5e8, .poisson_ratio = 0.3};
const dem::Hertz hertz{.elastic = soft, .restitution = 0.8};
const dem::Mindlin mindlin{.elastic = soft, .friction_angle = 0.4};
const dem::LinearSpringDashpot spring{.normal_stiffness = 1e6, .restitution = 0.8};
const dem::LinearFriction friction{.tangential_stiffness = 5e5, .friction_angle = 0.4};
const dem::RollingResistance rolling{.rolling_friction = 0.3, .twisting_friction = 0.2};

TEST(LossesOfContacts, AddUpByCause) {
  dem::Losses losses{.friction = 1, .rolling_friction = 2, .plastic = 3, .separation = 4};
  losses += {.friction = 10, .rolling_friction = 20, .plastic = 30, .separation = 40};
  EXPECT_EQ(losses.friction, 11);
  EXPECT_EQ(losses.rolling_friction, 22);
  EXPECT_EQ(losses.plastic, 33);
  EXPECT_EQ(losses.separation, 44);
  EXPECT_EQ(losses.sum(), 110);
}

TEST(EnergyLedgerOf, HertzAndMindlin) {
  const dem::Law law{hertz, mindlin};
  expect_to_close_at_moving_walls(law);
  expect_to_keep_momenta(law);
  expect_second_order(law);
}

TEST(EnergyLedgerOf, PartialSlip) {
  const dem::Law law{hertz, dem::MindlinDeresiewicz{.elastic = soft, .friction_angle = 0.4}};
  expect_to_close_at_moving_walls(law);
  expect_to_keep_momenta(law);
  expect_second_order(law);
}

TEST(EnergyLedgerOf, JkrAndMindlin) {
  const dem::Law law{dem::Jkr{.elastic = soft, .surface_energy = 300, .restitution = 0.8}, mindlin};
  expect_to_close_at_moving_walls(law);
  expect_to_keep_momenta(law);
  expect_second_order(law);
}

TEST(EnergyLedgerOf, LiquidBridges) {
  const dem::Law law{
      hertz, mindlin,
      dem::CapillaryBridge{.surface_tension = 1, .contact_angle = 0.2, .volume = 1e-8}};
  expect_to_close_at_moving_walls(law);
  expect_to_keep_momenta(law);
  expect_second_order(law);
}

TEST(EnergyLedgerOf, RollingResistance) {
  const dem::Law law{spring, friction, rolling};
  expect_to_close_at_moving_walls(law);
  expect_to_keep_momenta(law);
  expect_second_order(law);
}

TEST(EnergyLedgerOf, HertzAndMindlinWithRollingResistanceAndAdhesion) {
  const dem::Law law{hertz, mindlin, rolling, dem::DmtAdhesion{.surface_energy = 300}};
  expect_to_close_at_moving_walls(law);
  expect_to_keep_momenta(law);
  expect_second_order(law);
}

}  // namespace
}  // namespace silt::test::energy_ledger_parts_test
