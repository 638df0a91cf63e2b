// SPDX-License-Identifier: MIT
#include <silt/geometry/shapes.hpp>
#include <silt/measure/wall_load.hpp>
#include <silt/mps.hpp>

#include "support/check.hpp"
#include "support/fluid.hpp"
#include <gtest/gtest.h>

namespace silt::test::wall_load_test {
namespace {

constexpr double l0 = 0.02;  // [m]
constexpr double g = 9.81;   // [m/s²]

// Water at rest in a tank of eight spacings.
template <int Dim>
auto still_tank() {
  constexpr double side = 8 * l0;
  mps::Tank<Dim> tank{.column = {side, side}, .size = {.length = side, .height = 1.5 * side},
                      .spacing = l0};
  tank.size.depth = side;
  const auto made = mps::make_tank<mps::Recommended, Dim>(tank);
  Simulation still{made.particles, UniformGrid<Dim>{},
                   mps::Flow<mps::Recommended, Dim>{
                       {.spacing = l0, .speed_scale = 1, .walls = made.walls}},
                   SemiImplicit<>{}};
  for (int k = 0; k < 5; ++k) still.step();
  return still;
}

TEST(WallLoad, IsTheHydrostaticForce) {
  constexpr double H = 8 * l0, force = 1000 * g * H * H / 2;
  const auto tank = still_tank<2>();
  const WallLoad<2> right{{{{Vec<2>(H, 0), Vec<2>(H, H)}}}};
  const WallLoad<2> floor{{{{Vec<2>(0, 0), Vec<2>(H, 0)}}}};
  EXPECT_NEAR(right.read(tank, mps::pressure)[0] / force, 1, 0.02);
  EXPECT_NEAR(right.read(tank, mps::pressure)[1], 0, 1e-9);
  EXPECT_NEAR(floor.read(tank, mps::pressure)[1] / (-2 * force), 1, 0.01);
}

TEST(WallLoad, IsTheHydrostaticForceIn3D) {
  constexpr double H = 8 * l0, weight = 1000 * g * H * H * H;
  const auto tank = still_tank<3>();
  const Vec<3> a{0, 0, 0}, b{H, 0, 0}, c{H, H, 0}, d{0, H, 0};
  const WallLoad<3> floor{{{{a, b, c}}, {{a, c, d}}}};
  EXPECT_NEAR(floor.read(tank, mps::pressure)[2] / -weight, 1, 0.02);
}

TEST(WallLoad, IsOfTheSideOfTheNormalsOnly) {
  constexpr double H = 8 * l0;
  const auto tank = still_tank<2>();
  const WallLoad<2> outside{{{{Vec<2>(H, H), Vec<2>(H, 0)}}}};
  EXPECT_EQ(outside.read(tank, mps::pressure)[0], 0);
}

// A drop that a wall stops by collisions has no pressure. In the corner of two triangles, it counts
// once.
TEST(WallLoad, IncludesCollisions) {
  const double dt = 1e-3;
  mps::FlowSettings<3, mps::Recommended> settings{.spacing = l0, .gravity = Vec<3>::Zero()};
  const Vec<3> a{0, 0, 0}, b{1, 0, 0}, c{1, 1, 0}, d{0, 1, 0};
  settings.walls.triangles = {{{a, b, c}}, {{a, c, d}}};
  mps::Fluid<3> drop;
  mps::add_particle(drop, {0.5, 0.5, 0.5 * l0}, mps::Kind::fluid);
  drop[velocity][0] = {0, 0, -5};
  Simulation impact{drop, UniformGrid<3>{}, mps::Flow<mps::Recommended, 3>{settings},
                    SemiImplicit<>{}};
  const WallLoad<3> wall{settings.walls.triangles};
  EXPECT_EQ(wall.read(impact, mps::pressure), (Vec<3>::Zero()));
  impact.step(dt);
  const double stopped = impact.particles()[velocity][0][2] + 5;
  EXPECT_GT(stopped, 1);
  EXPECT_NEAR(wall.read(impact, mps::pressure)[2] * dt / (-1000 * l0 * l0 * l0 * stopped), 1, 1e-5);
}

TEST(WallLoad, OfAllWallsOfATankIsTheWeight) {
  constexpr double H = 8 * l0;
  const auto in_2d = still_tank<2>();
  const WallLoad<2> all_in_2d{in_2d.interaction().settings().walls.segments};
  const Vec<2> load = all_in_2d.read(in_2d, mps::pressure);
  EXPECT_NEAR(load[0] / (1000 * g * H * H), 0, 0.01);
  EXPECT_NEAR(load[1] / (-1000 * g * H * H), 1, 0.01);
  const auto in_3d = still_tank<3>();
  const WallLoad<3> all_in_3d{in_3d.interaction().settings().walls.triangles};
  EXPECT_NEAR(all_in_3d.read(in_3d, mps::pressure)[2] / (-1000 * g * H * H * H), 1, 0.02);
}

TEST(WallLoad, RefusesAFaceWithoutSize) {
  const auto tank = still_tank<2>();
  const WallLoad<2> point{{{{Vec<2>(1, 1), Vec<2>(1, 1)}}}};
  EXPECT_TRUE(refuses([&] { point.read(tank, mps::pressure); }, {"WallLoad: face 0"}));
}

}  // namespace
}  // namespace silt::test::wall_load_test
