// SPDX-License-Identifier: MIT
// Walls at the sides of a periodic box: they act on grains across a side as anywhere else, or are
// refused.
// Only with --all: every wall there; walls_test.cpp refuses a plane that breaks off at a side.
#include <silt/dem.hpp>
#include <silt/dem/wall/walls.hpp>

#include "support/check.hpp"
#include "support/grains.hpp"
#include "support/triangles.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace silt::test::walls_at_sides_test {
namespace {

const dem::CundallStrack law{.normal_stiffness = 1e5};
constexpr double R = pebble.radius;

template <int Dim>
Box<Dim> periodic_along_x() {
  Box<Dim> box;
  box.lower.setConstant(-1);
  box.upper.setConstant(1);
  box.lower[0] = 0;
  box.periodic[0] = true;
  return box;
}

// A simulation of one grain at rest at x, after one step.
template <int Dim, class W>
auto step_of_a_grain_at(const Vec<Dim>& x, const W& wall) {
  auto grains = one_grain<Dim>(x, Vec<Dim>(Vec<Dim>::Zero()));
  grains.set_box(periodic_along_x<Dim>());
  Simulation simulation{grains, UniformGrid<Dim>{}, dem::Contacts{law, wall}, Leapfrog{}};
  simulation.step(1e-6);
  return simulation;
}
template <int Dim, class W>
testing::AssertionResult is_refused_at(const Vec<Dim>& x, const W& wall) {
  return refuses([&] { step_of_a_grain_at<Dim>(x, wall); },
                 {"dem::Contacts: wall 0 breaks off at a periodic side: a grain at x = ",
                  "continue the wall beyond the side"});
}

TEST(WallsAtSides, MayEndThereIfTheyGoOnAtTheOtherSide) {
  for (const double x : {1e-9, 0.3 * R, 0.5, 1 - 0.3 * R, 1.0}) {
    const Vec<2> at(x, 0.99 * R);
    const double expected = 0.01 * R * 1e5;
    const auto on = [&](const auto& floor) {
      return step_of_a_grain_at<2>(at, floor).particles()[force][0];
    };
    const dem::Segment<> segment{.from = {0, 0}, .to = {1, 0}};
    const dem::Polyline<> line{.points = {{0, 0}, {0.4, 0}, {0.6, 0.001}, {0.8, 0}, {1, 0}}};
    const dem::BoxWall<2> block{.box = {.lower = {0, -0.5}, .upper = {1, 0}},
                                .grains = dem::Side::outside};
    EXPECT_LT((on(dem::Plane<2>{}) - Vec<2>(0, expected)).norm(), 1e-9) << x;
    EXPECT_LT((on(segment) - Vec<2>(0, expected)).norm(), 1e-9) << x;
    EXPECT_LT((on(block) - Vec<2>(0, expected)).norm(), 1e-9) << x;
    EXPECT_NO_THROW(on(line)) << x;
  }
}

TEST(WallsAtSides, AreRefusedWhereAGrainTouchesThemFromTheOtherSideOnly) {
  const dem::Polyline<> post{.points = {{0, 0}, {1 - R / 2, 0}, {1 - R / 2, 3 * R}, {1, 0}}};
  EXPECT_TRUE(is_refused_at<2>({R / 4, 2 * R}, post));
  EXPECT_NO_THROW(step_of_a_grain_at<2>({1.5 * R, 2 * R}, post));
  const dem::BoxWall<2> block{.box = {.lower = {0.9, 0}, .upper = {1 - R / 2, 0.1}},
                              .grains = dem::Side::outside};
  EXPECT_TRUE(is_refused_at<2>({R / 4, 0.05}, block));
  const dem::Segment<> sloping{.from = {0, 0}, .to = {1, 0.1}};
  EXPECT_TRUE(is_refused_at<2>({R / 4, 0.1}, sloping));
  EXPECT_NO_THROW(step_of_a_grain_at<2>({0.5, 0.1}, sloping));
  const dem::Cylinder<> across{
      .from = {1 - R, 0, -1}, .to = {1 - R, 0, 1}, .radius = R / 2, .grains = dem::Side::outside};
  EXPECT_TRUE(is_refused_at<3>({R / 4, 0, 0}, across));
  const dem::Cylinder<> along{
      .from = {0, 0, 0}, .to = {1, 0, 0}, .radius = 0.1, .grains = dem::Side::inside};
  EXPECT_NO_THROW(step_of_a_grain_at<3>({R / 4, 0, 0.1 - 0.99 * R}, along));
}

TEST(WallsAtSides, AreRefusedWhenTheyArriveThere) {
  const dem::Moving piston{dem::Segment<>{.from = {0.9, 0}, .to = {0.9, 0.1}},
                           dem::Translation<2>{.velocity = {1, 0}}};
  auto grains = one_grain<2>({R / 4, 0.05}, {0, 0});
  grains.set_box(periodic_along_x<2>());
  Simulation simulation{grains, UniformGrid<2>{}, dem::Contacts{law, piston}, Leapfrog{}};
  simulation.run({.until = 0.085, .time_step = 1e-4});
  EXPECT_TRUE(refuses([&] { simulation.run({.until = 0.1, .time_step = 1e-4}); },
                      {"dem::Contacts: wall 0 breaks off at a periodic side"}));
}

// A corrugated sheet over one period of the box, beginning at any phase.
Triangles sheet(double begin) {
  Triangles all;
  add_patch(all, 20, [&](double u, double v) {
    return Vec<3>(u + begin, 4 * R * (v - 0.5), R * std::sin(2 * std::numbers::pi * 5 * u));
  });
  return all;
}

TEST(WallsAtSides, OfCopiedTrianglesActAsAnywhereElse) {
  const auto box = periodic_along_x<3>();
  const auto copied = [&](double begin) {
    return dem::MeshWall<>{dem::with_periodic_copies(sheet(begin), box, 2 * R)};
  };
  const auto step_at = [](double x, const dem::MeshWall<>& wall) {
    return step_of_a_grain_at<3>({x - std::floor(x), 0.001, 1.6 * R}, wall);
  };
  int touching = 0;
  // The sheet leaves the box; its copies come in from the other side.
  for (const double shift : {-0.5, -0.237, 0.1}) {
    const auto here = copied(0);
    const auto there = copied(shift);
    for (double u = 0.0003; u < 1; u += 0.0071) {
      const auto inside = step_at(u, here);
      const auto across = step_at(u + shift, there);
      const Vec<3> difference = inside.particles()[force][0] - across.particles()[force][0];
      EXPECT_LT(difference.norm(), 1e-9 * 1e5 * R) << u << " shifted by " << shift;
      EXPECT_EQ(inside.interaction().size(), across.interaction().size()) << u;
      touching += inside.interaction().size() > 0;
    }
  }
  EXPECT_GT(touching, 50);
  const dem::MeshWall<> without{sheet(0)};
  EXPECT_TRUE(is_refused_at<3>({0.999, 0.001, 0.8 * R}, without));
  EXPECT_NO_THROW(step_of_a_grain_at<3>({0.999, 0.001, 0.8 * R}, copied(0)));
}

TEST(PeriodicCopies, AreThoseNearTheBox) {
  const auto box = periodic_along_x<3>();
  const Triangles one{{{Vec<3>(0.01, 0, 0), Vec<3>(0.02, 0, 0), Vec<3>(0.01, 0.1, 0)}}};
  EXPECT_EQ(dem::with_periodic_copies(one, box, 0.005).size(), 1u);
  const auto two = dem::with_periodic_copies(one, box, 0.011);
  ASSERT_EQ(two.size(), 2u);
  EXPECT_EQ(two[1].corners[1], Vec<3>(1.02, 0, 0));
  EXPECT_TRUE(refuses([&] { dem::with_periodic_copies(one, box, 0.0); },
                      {"with_periodic_copies: distance = 0 must be positive"}));
}

}  // namespace
}  // namespace silt::test::walls_at_sides_test
