// SPDX-License-Identifier: MIT
#include <silt/geometry/shapes.hpp>
#include <silt/mps.hpp>
#include <silt/mps/filling/fill.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include "support/check.hpp"
#include "support/fluid.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace silt::test::fill_test {
namespace {

constexpr double l0 = 0.02;  // [m]

mps::ImageWalls v_of_a_right_angle() {
  return {.segments = polyline({{-0.2, 0.2}, {0, 0}, {0.2, 0.2}})};
}

// No other test proves that a pool of whole cells has the particles of a tank, to the bit.
template <int Dim, class Real>
void expect_those_of_a_tank() {
  const auto tank = mps::make_tank<mps::Recommended, Dim, Real>(
      {.column = {0.16, 0.1},
       .size = {.length = 0.16, .height = 0.3, .depth = 0.08},
       .spacing = l0});
  mps::Fluid<Dim, Real> water;
  Vec<Dim> inside = Vec<Dim>::Constant(0.03);
  const mps::Filling filling =
      mps::fill(water, tank.walls, {.inside = inside, .level = 0.1, .spacing = l0});
  ASSERT_EQ(water.size(), tank.particles.size());
  EXPECT_EQ(filling.particles, water.size());
  EXPECT_EQ(filling.deviation, 0);
  for (Index i = 0; i < water.size(); ++i) {
    EXPECT_EQ(water[position][i], tank.particles[position][i]);
  }
}
TEST(Fill, KeepsTheLatticeWhereItFits) {
  expect_those_of_a_tank<2, double>();
  expect_those_of_a_tank<2, float>();
  expect_those_of_a_tank<3, double>();
}

// No other test proves that the volume of a room is exact: partly wetted faces, a body, a beach in
// space.
TEST(Fill, HasAParticleForEachCellOfTheVolume) {
  const auto volume = []<int Dim>(const mps::ImageWalls& walls, const mps::Pool<Dim>& pool) {
    mps::Fluid<Dim> water;
    const mps::Filling filling = mps::fill(water, walls, pool);
    EXPECT_EQ(filling.particles, water.size());
    EXPECT_LE(std::abs(double(water.size()) - filling.volume / std::pow(pool.spacing, Dim)), 0.5);
    return filling.volume;
  };
  EXPECT_NEAR(
      volume(v_of_a_right_angle(), mps::Pool<2>{.inside = {0, 0.05}, .level = 0.13, .spacing = l0}),
      0.13 * 0.13, 1e-9);
  mps::ImageWalls tank{.segments = polyline({{0, 0.4}, {0, 0}, {0.41, 0}, {0.41, 0.4}})};
  tank.moving_2d = mps::MovingWalls<2>{
      .bodies = {
          {.faces = polyline({{0.1, 0.15}, {0.25, 0.15}, {0.25, 0.3}, {0.1, 0.3}, {0.1, 0.15}}),
           .density = 500}}};
  EXPECT_NEAR(volume(tank, mps::Pool<2>{.inside = {0.05, 0.05}, .level = 0.23, .spacing = l0}),
              0.41 * 0.23 - 0.15 * 0.08, 1e-9);
}

// No other test proves that water between walls that no lattice fits begins at rest.
TEST(Fill, LeavesWaterAtRestInAV) {
  const auto walls = v_of_a_right_angle();
  mps::Fluid<2> water;
  mps::fill(water, walls, {.inside = {0, 0.1}, .level = 0.15, .spacing = l0});
  const double scale = std::sqrt(9.81 * 0.15);
  const mps::Flow<mps::Recommended> flow{{.spacing = l0, .speed_scale = scale, .walls = walls}};
  Simulation still{water, UniformGrid<2>{}, flow, SemiImplicit<>{}};
  still.run({.until = 0.3});
  double fastest = 0;
  for (const auto& u : still.particles()[velocity]) fastest = std::max(fastest, u.norm());
  EXPECT_LT(fastest, 2e-3 * scale);
}

// No other test proves that no particle begins inside of an obstacle, at its corners.
TEST(Fill, BeginsOutsideOfObstacles) {
  int beside_corners = 0;
  for (int k = 0; k < 60; ++k) {
    const Vec<2> lower(0.157 - 0.0031 * k, 0.191 - 0.00235 * k), upper = lower + Vec<2>(0.11, 0.13);
    auto walls = polyline({{0, 0.4}, {0, 0}, {0.41, 0}, {0.41, 0.4}});
    for (const auto& face : faces_of(Box<2>{lower, upper})) walls.push_back(face);
    const Faces<2> faces("walls", walls);
    const mps::detail::PoolRoom<2> room(faces,
                                        {.inside = {0.38, 0.03}, .level = 0.35, .spacing = l0});
    for (const Vec<2>& x : mps::detail::cells_of(room).points) {
      EXPECT_TRUE(room.is_wet(x)) << k << ": " << x.transpose();
      beside_corners += (x - lower).norm() < l0 / 2;
    }
  }
  EXPECT_GT(beside_corners, 10);
}

// No other test proves that a wrong pool is refused with what is wrong.
TEST(Fill, RefusesWhatIsNoPool) {
  mps::Fluid<2> water;
  const auto refused = [&](const mps::ImageWalls& walls, const mps::Pool<2>& pool,
                           const std::string& message) {
    return refuses([&] { mps::fill(water, walls, pool); }, {message});
  };
  const mps::ImageWalls tank{.segments = polyline({{0, 0.3}, {0, 0}, {0.2, 0}, {0.2, 0.3}})};
  const mps::Pool<2> pool{.inside = {0.1, 0.05}, .level = 0.1, .spacing = l0};
  const auto with = [&](auto&& change) {
    mps::Pool<2> changed = pool;
    change(changed);
    return changed;
  };
  EXPECT_TRUE(refused(tank, with([](auto& p) { p.spacing = 0; }), "Pool: spacing = 0"));
  EXPECT_TRUE(refused(tank, with([](auto& p) { p.level = nan; }), "Pool: level is not given"));
  EXPECT_TRUE(refused(tank, with([](auto& p) { p.inside[0] = nan; }), "Pool: inside"));
  EXPECT_TRUE(refused(tank, with([](auto& p) { p.level = 0.04; }), "is not below level = 0.04 m"));
  EXPECT_TRUE(refused(tank, with([](auto& p) { p.inside[0] = 0.3; }), "is beyond all walls"));
  EXPECT_TRUE(
      refused(tank, with([](auto& p) { p.level = 0.35; }), "the walls do not hold the water"));
  EXPECT_TRUE(refused(tank, with([](auto& p) { p.spacing = 1e-6; }), "increase the spacing"));
  EXPECT_TRUE(refused({}, pool, "there are no faces"));
  mps::ImageWalls leaking = tank;
  leaking.segments[1].corners[1][0] = 0.1;  // half of the floor
  EXPECT_TRUE(refused(leaking, pool, "it would run out near"));
  mps::ImageWalls gap = tank;
  gap.segments.push_back({{Vec<2>(0.173, 0), Vec<2>(0.173, 0.3)}});
  EXPECT_TRUE(
      refused(gap, with([](auto& p) { p.inside[0] = 0.19; }), "narrower than two spacings"));
  mps::ImageWalls on_wall = tank;
  on_wall.segments.push_back({{Vec<2>(0.1, 0), Vec<2>(0.1, 0.3)}});
  EXPECT_TRUE(refused(on_wall, pool, "is on a wall"));
  EXPECT_TRUE(refused(tank, with([](auto& p) { p.inside[1] = 0; }), "is on a wall"));
  std::vector<Vec<2>> round;
  for (int k = 0; k <= 200; ++k) {
    const double angle = 2 * std::numbers::pi * (k % 200) / 200;
    round.push_back({0.1 + 0.1 * std::cos(angle), 0.1 + 0.1 * std::sin(angle)});
  }
  const mps::ImageWalls of_many_faces{.segments = polyline(round)};
  EXPECT_TRUE(refused(of_many_faces, {.inside = {0.1, 0.05}, .level = 0.19, .spacing = 0.02},
                      "find no places where they rest"));
  EXPECT_TRUE(water.empty());
  mps::fill(water, tank, pool);
  EXPECT_TRUE(refused(tank, pool, "there is a particle already"));
  mps::Fluid<2> periodic{Box<2>{.lower = {0, 0}, .upper = {0.2, 1}, .periodic = {true, false}}};
  EXPECT_TRUE(refuses([&] { mps::fill(periodic, tank, pool); }, {"the box is periodic"}));
  mps::Fluid<2> small{Box<2>{.lower = {0, 0}, .upper = {0.1, 1}}};
  EXPECT_TRUE(refuses([&] { mps::fill(small, tank, pool); }, {"beyond the box of the particles"}));
}

}  // namespace
}  // namespace silt::test::fill_test
