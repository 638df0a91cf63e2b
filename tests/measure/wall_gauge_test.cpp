// SPDX-License-Identifier: MIT
#include <silt/core/lattice.hpp>
#include <silt/geometry/shapes.hpp>
#include <silt/measure/wall_gauge.hpp>
#include <silt/mps.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include "support/check.hpp"
#include "support/fluid.hpp"
#include "support/probed_water.hpp"
#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace silt::test::wall_gauge_test {
namespace {

constexpr double l0 = probed_l0;  // [m]

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

// --- in sight, of a simulation
// --------------------------------------------------------------------

mps::Fluid<2> water_in(const Box<2>& body, double value) {
  mps::Fluid<2> water;
  for (const auto& x : lattice<2>({body.lower * l0, body.upper * l0}, l0)) {
    const Index i = mps::add_particle(water, x, mps::Kind::fluid);
    water[mps::pressure][i] = value;
  }
  return water;
}

// A thin gate, behind which the floor is dry; and a sheet that leaves an edge, before a dry face
// below.
TEST(WallGauge, SeesOnlyFluidAtItsWall) {
  const auto before_gate = water_in({{-8, 0}, {0, 8}}, 1000);
  auto walls = line({{-8, 20}, {-8, 0}, {8, 0}, {8, 20}});
  walls.push_back(line({{0, 0}, {0, 20}})[0]);
  const auto gate = with_walls<2>(before_gate, walls);
  const auto on_floor = [](double x) { return WallGauge<2>{{x * l0, 0}, {0, 1}, l0}; };
  EXPECT_GT(on_floor(0.3).read(before_gate, mps::pressure), 500);
  EXPECT_EQ(on_floor(0.3).read(gate, mps::pressure), 0);
  EXPECT_NEAR(on_floor(-0.3).read(gate, mps::pressure), 1000, 1e-9);
  const WallGauge<2> on_gate{.point = {0, 3 * l0}, .spacing = l0};  // on the wet side of itself
  EXPECT_NEAR(on_gate.read(gate, mps::pressure), 1000, 1e-9);

  const auto sheet = water_in({{-8, 0}, {8, 6}}, 700);
  const auto ledge = with_walls<2>(sheet, line({{-8, 0}, {0, 0}, {0, -8}, {8, -8}}));
  const WallGauge<2> below{{0, -0.5 * l0}, {1, 0}, l0};
  EXPECT_GT(below.read(sheet, mps::pressure), 600);
  EXPECT_EQ(below.read(ledge, mps::pressure), 0);
  // Passing at a distance of more than a spacing and a half.
  const auto past = water_in({{1.2, -8}, {4, 8}}, 700);
  const auto fall = with_walls<2>(past, line({{-8, 0}, {0, 0}, {0, -8}, {8, -8}}));
  EXPECT_GT((WallGauge<2>{{0, -3 * l0}, {1, 0}, l0}.read(past, mps::pressure)), 100);
  EXPECT_EQ((WallGauge<2>{{0, -3 * l0}, {1, 0}, l0}.read(fall, mps::pressure)), 0);
}

// With the normal of the nearest face, of a face that is given, and in a corner of the given one.
TEST(WallGauge, TakesTheNearestFaceForItsNormal) {
  auto water = water_with_pressure<2>(0);
  const auto faces = line({{0, 20}, {0, 0}, {8, 0}, {8, 20}});
  const auto sim = with_walls<2>(water, faces);
  constexpr double error = 0.03 * 9810 * l0;
  const auto read = [&](const WallGauge<2>& gauge) { return gauge.read(sim, mps::pressure); };
  EXPECT_NEAR(read({.point = {4 * l0, 0}, .spacing = l0}), 1000 + 2000 * l0, error);
  EXPECT_NEAR(read({.point = {4 * l0, -0.4 * l0}, .spacing = l0}), 1000 + 2000 * l0, error);
  EXPECT_NEAR(read(WallGauge<2>::at(line({{0, 8}, {0, 2}})[0], l0)), 1000 - 9810 * 5 * l0, error);
  EXPECT_EQ(read(WallGauge<2>::at(reversed(line({{0, 8}, {0, 2}})[0]), l0)), 0);
  EXPECT_NEAR(read({.point = {0, 0}, .spacing = l0}), 1000, error);
  EXPECT_NEAR(read({.point = {0, 0}, .normal = {1, 0}, .spacing = l0}), 1000, error);

  const auto block = water_with_pressure<3>(0);
  const auto tank = with_walls<3>(
      block, faces_of(Box<3>{.lower = {0, 0, 0}, .upper = {8 * l0, 8 * l0, 1}}, Sides<3>::open()));
  const WallGauge<3> side{.point = {0, 4 * l0, 4 * l0}, .spacing = l0};
  EXPECT_NEAR(side.read(tank, mps::pressure), 1000 - 4 * 9810 * l0, error);
  const WallGauge<3> corner{.point = {0, 0, 0}, .normal = {0, 0, 1}, .spacing = l0};
  EXPECT_NEAR(corner.read(tank, mps::pressure), 1000, 2 * error);
}

// By the load, still water has its pressure at walls along the axes; next to corners to 3 % of that
// of its depth, as a part of the weight is beyond them.
TEST(WallGauge, ReadsThePressureOfStillWaterByTheLoad) {
  auto tank =
      with_walls<2>(water_in({{0, 0}, {12, 12}}, 0), line({{0, 30}, {0, 0}, {12, 0}, {12, 30}}));
  auto box = with_walls<3>(
      [] {
        mps::Fluid<3> water;
        for (const auto& x : lattice<3>({{0, 0, 0}, {6 * l0, 6 * l0, 8 * l0}}, l0)) {
          mps::add_particle(water, x, mps::Kind::fluid);
        }
        return water;
      }(),
      faces_of(Box<3>{.lower = {0, 0, 0}, .upper = {6 * l0, 6 * l0, 1}}, Sides<3>::open()));
  EXPECT_EQ((WallGauge<2>{.point = {0, 0}, .spacing = l0}.read_load(tank)),
            0);  // before the first step
  for (int k = 0; k < 5; ++k) tank.step(), box.step();
  constexpr double H = 12 * l0, error = 0.032 * 9810 * H;
  for (const double y : {0.3, 1.0, 4.2, 9.0, 11.0}) {
    for (const double x : {0.0, 12.0}) {
      const WallGauge<2> gauge{.point = {x * l0, y * l0}, .spacing = l0};
      EXPECT_NEAR(gauge.read_load(tank), 9810 * (H - y * l0), error) << x << ' ' << y;
      EXPECT_NEAR(gauge.read(tank, mps::pressure), 9810 * (H - y * l0), error) << x << ' ' << y;
    }
  }
  for (const double x : {0.3, 1.0, 4.2}) {
    const WallGauge<2> gauge{.point = {x * l0, 0}, .normal = {0, 1}, .spacing = l0};
    EXPECT_NEAR(gauge.read_load(tank), 9810 * H, error) << x;
  }
  EXPECT_EQ((WallGauge<2>{.point = {0, 20 * l0}, .spacing = l0}.read_load(tank)), 0);
  const WallGauge<3> floor{.point = {2.2 * l0, 3 * l0, 0}, .spacing = l0};
  EXPECT_NEAR(floor.read_load(box) / (9810 * 8 * l0), 1, 0.015);
  const WallGauge<3> side{.point = {0, 1.3 * l0, 3 * l0}, .spacing = l0};
  EXPECT_NEAR(side.read_load(box) / (9810 * 5 * l0), 1, 0.015);
}

// On a wall that moves, while the gauge that does not finds no wall any more.
TEST(WallGauge, MovesWithItsWall) {
  constexpr double speed = 0.7, H = 8 * l0;
  mps::FlowSettings<2, mps::Recommended> settings{.spacing = l0, .speed_scale = 1};
  settings.walls.moving_2d = mps::MovingWalls<2>{.faces = {
      {.faces = line({{0, 30}, {0, 0}, {8, 0}, {8, 30}}), .motion = Translation<2>{{speed, 0}}}}};
  auto water = water_in({{0, 0}, {8, 8}}, 0);
  for (auto& u : water[velocity]) u = {speed, 0};
  Simulation sim{water, UniformGrid<2>{}, mps::Flow<mps::Recommended>{settings}, SemiImplicit<>{}};
  const WallGauge<2> on_wall{.point = {H, H / 2},
                             .normal = {-1, 0},
                             .spacing = l0,
                             .moves_with = WallGroup::moving_faces(0)};
  while (sim.time() < 0.1) sim.step();
  EXPECT_NEAR(on_wall.read(sim, mps::pressure) / (9810 * H / 2), 1, 0.01);
  EXPECT_NEAR(on_wall.read_load(sim) / (9810 * H / 2), 1, 0.02);
  const WallGauge<2> at_rest{.point = {H, H / 2}, .normal = {-1, 0}, .spacing = l0};
  EXPECT_TRUE(refuses([&] { at_rest.read(sim, mps::pressure); },
                      {"WallGauge: there is no wall", "moves_with"}));
  EXPECT_TRUE(refuses(
      [&] {
        WallGauge<2>{.point = {0, 0}, .spacing = l0, .moves_with = WallGroup::body(1)}.read_load(
            sim);
      },
      {"WallGauge", "body(1)", "0 bodies"}));
}

struct QuarterTurn {
  Pose<2> pose_at(double) const {
    Pose<2> pose;
    pose.rotation << 0, -1, 1, 0;
    return pose;
  }
  RigidVelocity<2> velocity_at(double) const { return {}; }
};
// Also before the first step, where the faces of the flow are not there yet.
TEST(WallGauge, TurnsWithItsWall) {
  mps::FlowSettings<2, mps::Recommended> settings{.spacing = l0, .speed_scale = 1};
  settings.walls.moving_2d = mps::MovingWalls<2>{.faces = {
      {.faces = line({{0, 20}, {0, 0}, {8, 0}, {8, 20}}), .motion = QuarterTurn{}}}};
  settings.walls.let_fluid_fall = true;
  auto water = water_in({{-8, 0}, {0, 8}}, 0);
  for (Index i = 0; i < water.size(); ++i) water[mps::pressure][i] = 9810 * water[position][i][1];
  Simulation sim{water, UniformGrid<2>{}, mps::Flow<mps::Recommended>{settings}, SemiImplicit<>{}};
  for (const Vec<2>& normal : {Vec<2>(0, 1), Vec<2>(0, 0)}) {
    const WallGauge<2> gauge{.point = {4 * l0, 0},
                             .normal = normal,
                             .spacing = l0,
                             .moves_with = WallGroup::moving_faces(0)};
    EXPECT_NEAR(gauge.read(sim, mps::pressure), 9810 * 4 * l0, 0.03 * 9810 * l0);
  }
}

// On the bottom of a floating body, which has sunk a little meanwhile.
TEST(WallGauge, MovesWithABody) {
  mps::FlowSettings<2, mps::Recommended> settings{.spacing = l0, .speed_scale = 1};
  settings.walls.segments = line({{0, 30}, {0, 0}, {20, 0}, {20, 30}});
  const Box<2> box{.lower = {7 * l0, 7 * l0}, .upper = {13 * l0, 13 * l0}};
  auto faces = faces_of(box);
  for (auto& face : faces) face = reversed(face);
  settings.walls.moving_2d = mps::MovingWalls<2>{.bodies = {{.faces = faces, .density = 550}}};
  mps::Fluid<2> water;
  for (const auto& x : lattice<2>({{0, 0}, {20 * l0, 10 * l0}}, l0)) {
    if (!box.contains(x)) mps::add_particle(water, x, mps::Kind::fluid);
  }
  Simulation sim{water, UniformGrid<2>{}, mps::Flow<mps::Recommended>{settings}, SemiImplicit<>{}};
  const WallGauge<2> gauge{
      .point = {10 * l0, 7 * l0}, .spacing = l0, .moves_with = WallGroup::body(0)};
  while (sim.time() < 0.1) sim.step();
  const double sunk =
      box.lower[1] + 3 * l0 - sim.interaction().walls().bodies()[0].state().position[1];
  EXPECT_GT(sunk, 0.05 * l0);
  EXPECT_NEAR(gauge.read(sim, mps::pressure) / (9810 * 3 * l0), 1, 0.2);
  EXPECT_NEAR(gauge.read_load(sim) / gauge.read(sim, mps::pressure), 1, 0.05);
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
