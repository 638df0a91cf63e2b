// SPDX-License-Identifier: MIT
#include <silt/measure/wall_gauge.hpp>
#include <silt/mps.hpp>

#include "support/check.hpp"
#include "support/fluid.hpp"
#include <gtest/gtest.h>

namespace silt::test::wall_gauge_test {
namespace {

constexpr double l0 = 0.02;  // [m]

template <int Dim>
auto water_with_pressure(double jitter) {
  auto water = blob<Dim, double>(8, l0, jitter);
  for (Index i = 0; i < water.size(); ++i) {
    const auto& x = water[position][i];
    water[mps::pressure][i] = 1000 + 500 * x[0] - 9810 * x[Dim - 1];
  }
  return water;
}

TEST(WallGauge, ReadsALinearFieldAtTheWall) {
  constexpr double error = 0.03 * 9810 * l0;  // of the change over a spacing
  for (const double jitter : {0.0, 0.2}) {
    const WallGauge<2> floor{{4 * l0, 0}, {0, 1}, l0};
    EXPECT_NEAR(floor.read(water_with_pressure<2>(jitter), mps::pressure), 1000 + 2000 * l0, error);
    const WallGauge<3> side{{0, 4 * l0, 4 * l0}, {1, 0, 0}, l0};
    EXPECT_NEAR(side.read(water_with_pressure<3>(jitter), mps::pressure), 1000 - 4 * 9810 * l0,
                error);
  }
}

TEST(WallGauge, ReadsOneSideOfAWallOnly) {
  auto water = blob<2, double>(8, l0);
  for (const double x : {-0.5, -1.5}) {
    const Index i = mps::add_particle(water, {x * l0, 4.5 * l0}, mps::Kind::fluid);
    water[mps::pressure][i] = 1e6;
  }
  for (Index i = 0; i < 64; ++i) water[mps::pressure][i] = 7;
  EXPECT_NEAR((WallGauge<2>{{0, 4 * l0}, {2, 0}, l0}.read(water, mps::pressure)), 7, 1e-12);
}

TEST(WallGauge, ReadsTheMeanOfFewParticlesAndZeroOfNone) {
  auto water = fluid_at<2, double>({{0.5 * l0, 0.5 * l0}});
  water[mps::pressure][0] = 30;
  const auto at = [&](double y) {
    return WallGauge<2>{{0, y * l0}, {1, 0}, l0}.read(water, mps::pressure);
  };
  EXPECT_NEAR(at(0.5), 30, 1e-9);
  EXPECT_EQ(at(5), 0);
  water[mps::pressure][0] = -30;
  EXPECT_EQ(at(0.5), 0);
}

// At 1.58 spacings, w = 0.141, and a quarter of that of a flat wall 0.524.
TEST(WallGauge, CountsDryPartsAsZero) {
  auto water = fluid_at<2, double>({{0.5 * l0, 0}});
  water[mps::pressure][0] = 30;
  const WallGauge<2> above{{0, 1.5 * l0}, {1, 0}, l0};
  EXPECT_NEAR(above.read(water, mps::pressure), 30 * 0.1406 / 0.5236, 0.01);
}

TEST(WallGauge, RefusesAWrongSpacingOrNormal) {
  const auto water = blob<2, double>(2, l0);
  EXPECT_TRUE(refuses([&] { (WallGauge<2>{{0, 0}, {1, 0}, 0}.read(water, mps::pressure)); },
                      {"WallGauge", "spacing"}));
  EXPECT_TRUE(refuses([&] { (WallGauge<2>{{0, 0}, {0, 0}, l0}.read(water, mps::pressure)); },
                      {"WallGauge", "normal"}));
  EXPECT_TRUE(refuses([&] { (WallGauge<2>{{0, nan}, {1, 0}, l0}.read(water, mps::pressure)); },
                      {"WallGauge", "point", "nan"}));
}

}  // namespace
}  // namespace silt::test::wall_gauge_test
