// SPDX-License-Identifier: MIT
#include <silt/core/lattice.hpp>
#include <silt/geometry/shapes.hpp>
#include <silt/measure/surface_height.hpp>
#include <silt/mps.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include "support/check.hpp"
#include "support/fluid.hpp"
#include "support/probed_water.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace silt::test::surface_height_test {
namespace {

constexpr double l0 = probed_l0;  // [m]

template <int Dim>
void add(mps::Fluid<Dim>& water, const Box<Dim>& body) {
  for (const auto& x : lattice<Dim>({body.lower * l0, body.upper * l0}, l0)) {
    mps::add_particle(water, x, mps::Kind::fluid);
  }
}
std::vector<Face<2>> tank(double length) {
  return line({{0, 50}, {0, 0}, {length, 0}, {length, 50}});
}
// All in spacings.
template <class Sim>
double height_at(const Sim& sim, double x, double highest = 1e9) {
  return SurfaceHeight<2>{.point = {x * l0, 0}, .spacing = l0, .highest = highest * l0}.read(sim) /
         l0;
}

// The level of water at rest, wherever the line is between the particles, and at walls.
TEST(SurfaceHeight, IsTheLevelOfStillWater) {
  mps::Fluid<2> water;
  add<2>(water, {{0, 0}, {16, 10}});
  const auto sim = with_walls<2>(water, tank(16));
  for (const double x : {0.0, 0.1, 0.3, 0.5, 1.0, 2.0, 4.2, 7.77, 15.9, 16.0}) {
    EXPECT_NEAR(height_at(sim, x), 10, 0.04) << x;
  }
}
TEST(SurfaceHeight, IsTheLevelOfStillWaterIn3D) {
  mps::Fluid<3> water;
  add<3>(water, {{0, 0, 0}, {10, 8, 6}});
  const auto sim = with_walls<3>(
      water, faces_of(Box<3>{.lower = {0, 0, 0}, .upper = {10 * l0, 8 * l0, 1}}, Sides<3>::open()));
  for (const double x : {0.0, 0.3, 4.2}) {
    for (const double y : {0.0, 0.4, 3.3}) {
      const SurfaceHeight<3> gauge{.point = {x * l0, y * l0, 0}, .spacing = l0};
      EXPECT_NEAR(gauge.read(sim) / l0, 6, 0.05) << x << ' ' << y;
    }
  }
}

// Water displaced as by a linear wave, so that its surface is known.
TEST(SurfaceHeight, FollowsASinusoidalSurface) {
  constexpr double wave = 50, depth = 15, k = 2 * std::numbers::pi / wave, a = 1;
  const auto displaced = [](double x, double y) {
    return Vec<2>(x - a * std::cosh(k * y) / std::sinh(k * depth) * std::sin(k * x),
                  y + a * std::sinh(k * y) / std::sinh(k * depth) * std::cos(k * x));
  };
  mps::Fluid<2> water;
  for (double x = 0.5; x < 2 * wave; ++x) {
    for (double y = 0.5; y < depth; ++y) {
      mps::add_particle(water, displaced(x, y) * l0, mps::Kind::fluid);
    }
  }
  const auto sim = with_walls<2>(water, tank(2 * wave));
  for (double x = 0; x <= 2 * wave; x += 1.37) {
    const Vec<2> exact = displaced(x, depth);
    EXPECT_NEAR(height_at(sim, exact[0]), exact[1], 0.05) << x;
  }
}

TEST(SurfaceHeight, IsThatOfThinFilms) {
  for (const double rows : {1.0, 2.0, 3.0}) {
    mps::Fluid<2> water;
    add<2>(water, {{0, 0}, {16, rows}});
    const auto sim = with_walls<2>(water, tank(16));
    for (const double x : {0.0, 0.3, 4.2}) EXPECT_NEAR(height_at(sim, x), rows, 0.04) << x;
  }
}

// A plate between two levels, and a beach.
TEST(SurfaceHeight, IsThatOfTheWaterInSight) {
  mps::Fluid<2> water;
  add<2>(water, {{0, 0}, {8, 10}});
  add<2>(water, {{8, 0}, {16, 6}});
  auto walls = tank(16);
  walls.push_back(line({{8, 0}, {8, 50}})[0]);
  const auto sim = with_walls<2>(water, walls);
  for (const double x : {6.0, 7.5, 7.99, 8.0}) EXPECT_NEAR(height_at(sim, x), 10, 0.04) << x;
  for (const double x : {8.01, 8.3, 9.0}) EXPECT_NEAR(height_at(sim, x), 6, 0.04) << x;

  mps::Fluid<2> lake;
  for (const auto& x : lattice<2>({{0, 0}, {40 * l0, 10 * l0}}, l0)) {
    if (x[1] - 0.5 * std::max(0.0, x[0] - 10 * l0) > 0.55 * l0) {
      mps::add_particle(lake, x, mps::Kind::fluid);
    }
  }
  const auto beach = with_walls<2>(lake, line({{0, 50}, {0, 0}, {10, 0}, {40, 15}}));
  for (const double x : {5.0, 10.0, 15.0, 20.0, 24.0, 26.0}) {
    EXPECT_NEAR(height_at(beach, x), 10, 0.02) << x;
  }
}

// Water on a deck, and below it, also where it touches the deck.
TEST(SurfaceHeight, IsTheHighestOne) {
  mps::Fluid<2> water;
  add<2>(water, {{0, 0}, {16, 10}});
  add<2>(water, {{4, 12}, {12, 14}});
  auto walls = tank(16);
  walls.push_back(line({{3, 12}, {16, 12}})[0]);
  const auto sim = with_walls<2>(water, walls);
  EXPECT_NEAR(height_at(sim, 8), 14, 0.02);
  EXPECT_NEAR(height_at(sim, 8, 11.5), 10, 0.02);
  EXPECT_NEAR(height_at(sim, 1), 10, 0.02);
  EXPECT_NEAR(height_at(sim, 15.5), 10, 0.04);
  walls.back() = line({{3, 10}, {16, 10}})[0];
  mps::Fluid<2> below;
  add<2>(below, {{0, 0}, {16, 10}});
  EXPECT_NEAR(height_at(with_walls<2>(below, walls), 8), 10, 0.02);
}

TEST(SurfaceHeight, IsNoNumberAtADryPlaceAndLeavesOutSpray) {
  mps::Fluid<2> water;
  add<2>(water, {{0, 0}, {6, 4}});
  mps::add_particle(water, {3.1 * l0, 9 * l0}, mps::Kind::fluid);
  const auto sim = with_walls<2>(water, tank(16));
  EXPECT_TRUE(std::isnan(height_at(sim, 12)));
  EXPECT_NEAR(height_at(sim, 3), 4, 0.02);
}

// Read in the frame of a tank that moves.
TEST(SurfaceHeight, MovesWithWalls) {
  constexpr double speed = 0.7;
  mps::FlowSettings<2, mps::Recommended> settings{.spacing = l0, .speed_scale = 1};
  settings.walls.moving_2d = mps::MovingWalls<2>{.faces = {{.faces = tank(8), .motion = Translation<2>{{speed, 0}}}}};
  mps::Fluid<2> water;
  add<2>(water, {{0, 0}, {8, 6}});
  for (auto& u : water[velocity]) u = {speed, 0};
  Simulation sim{water, UniformGrid<2>{}, mps::Flow<mps::Recommended>{settings}, SemiImplicit<>{}};
  const SurfaceHeight<2> on_wall{
      .point = {0, 0}, .spacing = l0, .moves_with = WallGroup::moving_faces(0)};
  const SurfaceHeight<2> at_rest{.point = {0, 0}, .spacing = l0};
  EXPECT_NEAR(on_wall.read(sim) / l0, 6, 0.02);
  while (sim.time() < 0.15) sim.step();
  EXPECT_NEAR(on_wall.read(sim) / l0, 6, 0.02);
  EXPECT_TRUE(std::isnan(at_rest.read(sim)));
}

TEST(SurfaceHeight, RefusesWhatItCannotRead) {
  mps::Fluid<2> water;
  add<2>(water, {{0, 0}, {6, 4}});
  const auto sim = with_walls<2>(water, tank(16));
  const auto is_refused = [&](const SurfaceHeight<2>& gauge, std::vector<std::string> words) {
    return refuses([&] { gauge.read(sim); }, words);
  };
  EXPECT_TRUE(is_refused({.point = {nan, 0}, .spacing = l0}, {"SurfaceHeight: point", "nan"}));
  EXPECT_TRUE(is_refused({.point = {0, 0}}, {"SurfaceHeight: spacing", "0"}));
  EXPECT_TRUE(is_refused({.point = {0, 0}, .spacing = l0, .lowest = 1, .highest = 1},
                         {"SurfaceHeight: highest", "lowest"}));
  EXPECT_TRUE(is_refused({.point = {0, 0}, .spacing = l0, .lowest = nan}, {"not a number"}));
  EXPECT_TRUE(is_refused({.point = {0, 0}, .spacing = l0, .moves_with = WallGroup::body(2)},
                         {"SurfaceHeight", "body(2)", "0 bodies"}));
  mps::add_particle(water, {l0, 1e6}, mps::Kind::fluid);
  const auto far = with_walls<2>(water, tank(16));
  EXPECT_TRUE(refuses([&] { SurfaceHeight<2>{.point = {0, 0}, .spacing = l0}.read(far); },
                      {"SurfaceHeight: there is fluid from", "lowest and highest"}));
  EXPECT_NEAR(height_at(far, 0, 100), 4, 0.02);
}

}  // namespace
}  // namespace silt::test::surface_height_test
