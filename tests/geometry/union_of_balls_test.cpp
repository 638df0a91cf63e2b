// SPDX-License-Identifier: MIT
// Volume, centre and moment of inertia of balls that overlap, against formulas and against the same
// balls turned; no other test has bodies of balls.
#include <silt/geometry/union_of_balls.hpp>

#include "support/check.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace silt::test::union_of_balls_test {
namespace {

constexpr double pi = std::numbers::pi;

template <int Dim>
MassProperties<Dim> body_of(const std::vector<Ball<Dim>>& balls, double density = 1) {
  return mass_properties_of<Dim>("body", balls, density);
}

TEST(UnionOfBalls, IsExactForOne) {
  const auto disc = body_of<2>({{{3, -2}, 0.5}}, 7);
  EXPECT_NEAR(disc.mass, 7 * pi / 4, 1e-14);
  EXPECT_NEAR(disc.inertia, disc.mass / 8, 1e-14);
  const auto sphere = body_of<3>({{{3, -2, 1e3}, 0.5}}, 7);
  EXPECT_NEAR(sphere.mass, 7 * pi / 6, 1e-13);
  EXPECT_LT((sphere.centre - Vec<3>(3, -2, 1e3)).norm(), 1e-12);
  EXPECT_LT((sphere.inertia - Inertia<3>(Inertia<3>::Identity() * sphere.mass / 10)).norm(), 1e-13);
}

TEST(UnionOfBalls, CountsACommonPartOnce) {
  // Equal ones at a distance of their radius: less the lens between them.
  const auto discs = body_of<2>({{{0, 0}, 1}, {{1, 0}, 1}});
  EXPECT_NEAR(discs.mass, 2 * pi - (2 * pi / 3 - std::sqrt(3) / 2), 1e-13);
  EXPECT_LT((discs.centre - Vec<2>(0.5, 0)).norm(), 1e-13);
  const auto spheres = body_of<3>({{{0, 0, 0}, 1}, {{1, 0, 0}, 1}});
  EXPECT_NEAR(spheres.mass, 8 * pi / 3 - 5 * pi / 12, 1e-10);
  // About the axis: ½ ∫ π r⁴ dx of both parts.
  EXPECT_NEAR(spheres.inertia(0, 0), pi * (8.0 / 15 + 1.0 / 2 - 1.0 / 12 + 1.0 / 160), 1e-10);
  // One within another, and one twice.
  const auto same = body_of<3>({{{0, 0, 0}, 1}, {{0.2, 0.1, 0}, 0.5}, {{0, 0, 0}, 1}});
  EXPECT_NEAR(same.mass, 4 * pi / 3, 1e-12);
  // Apart: Steiner.
  const auto two = body_of<3>({{{0, 0, 0}, 1}, {{0, 0, 4}, 1}});
  EXPECT_NEAR(two.inertia(0, 0), 2 * (0.4 + 4) * 4 * pi / 3, 1e-10);
}

TEST(UnionOfBalls, TurnsWithItsBalls) {
  const std::vector<Ball<3>> balls{{{0, 0, 0}, 1},
                                   {{0.5, 0.3, 0.2}, 0.8},
                                   {{-0.4, 0.6, 0.1}, 0.7},
                                   {{0.1, -0.5, 0.6}, 0.9},
                                   {{0.1, 1.2, 1.3}, 0.4}};
  const auto body = body_of<3>(balls);
  const auto turn = rotation_about(Vec<3>(Vec<3>(1, -2, 0.5).normalized()), 1.1);
  std::vector<Ball<3>> turned;
  for (const Ball<3>& ball : balls) {
    turned.push_back({Vec<3>(turn * ball.centre + Vec<3>(5, 6, 7)), ball.radius});
  }
  const auto other = body_of<3>(turned);
  EXPECT_NEAR(other.mass / body.mass, 1, 1e-9);
  EXPECT_LT((other.centre - turn * body.centre - Vec<3>(5, 6, 7)).norm(), 1e-9);
  EXPECT_LT((other.inertia - turn * body.inertia * turn.transpose()).norm(),
            1e-9 * body.inertia.norm());
}

TEST(UnionOfBalls, RefusesWhatIsNoBody) {
  EXPECT_TRUE(refuses([] { body_of<3>({}); }, {"body: there are no spheres"}));
  EXPECT_TRUE(refuses([] { body_of<3>({{{0, 0, 0}, -1}}); }, {"body: radius of a sphere = -1"}));
  EXPECT_TRUE(refuses([] { body_of<3>({{{0, 0, NAN}, 1}}); }, {"body: centre of a sphere"}));
  EXPECT_TRUE(refuses([] { body_of<2>({{{0, 0}, 1}}, 0); }, {"body: density = 0"}));
}

}  // namespace
}  // namespace silt::test::union_of_balls_test
