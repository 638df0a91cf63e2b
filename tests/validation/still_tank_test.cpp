// SPDX-License-Identifier: MIT
// The pressure of water at rest on the floor is ρ g h. The distance of the wall particles of the
// floor from the particles of the free surface, where P = 0, is the depth of the water.
// Only with --all: a comparison of whole flows.
#include "support/still_tank.hpp"

#include <gtest/gtest.h>

namespace silt::test::still_tank_test {
namespace {

using mps::Case10;

TEST(StillTank, HasTheHydrostaticPressureOnItsFloor) {
  const mps::Tank<2> tank{
      .column = {0.4, 0.4}, .size = {.length = 0.4, .height = 0.4}, .spacing = 0.02};
  const auto floor = floor_pressure<Case10>(tank, 0.3, 0.6);
  EXPECT_NEAR(floor.mean / 3924, 1, 0.05);
  EXPECT_LT(floor.scatter, 0.03);
}

TEST(StillTank, HasTheHydrostaticPressureOnItsFloorIn3DToOneSpacing) {
  // The depth is only eight spacings, and the position of the surface is uncertain by one.
  const double l0 = 0.05;
  const mps::Tank<3> tank{.column = {8 * l0, 8 * l0},
                          .size = {.length = 8 * l0, .height = 10 * l0, .depth = 8 * l0},
                          .spacing = l0};
  const auto floor = floor_pressure<Case10>(tank, 0.15, 0.3);
  EXPECT_NEAR(floor.mean / (1000 * 9.81 * 8 * l0), 1, 1.0 / 8);
  EXPECT_LT(floor.scatter, 0.03);
}

}  // namespace
}  // namespace silt::test::still_tank_test
