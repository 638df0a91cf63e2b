// SPDX-License-Identifier: MIT
// That contacts of discs and spheres are those of their own shape, whatever faces the fluid sees.
#include <silt/geometry/mass_properties.hpp>
#include <silt/geometry/shapes.hpp>
#include <silt/mps.hpp>
#include <silt/mps/wall/image_walls.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include "support/check.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

namespace silt::test::round_bodies_test {
namespace {

constexpr double l0 = 0.02, radius = 0.1, g = 9.81;  // [m], [m], [m/s²]

template <int Dim>
std::vector<Face<Dim>> faces_of_ball(const Vec<Dim>& centre, double edge = 0.05) {
  if constexpr (Dim == 2) {
    return faces_of_disc(centre, radius, edge);
  } else {
    return faces_of_sphere(centre, radius, edge);
  }
}

// Bodies in a tank that is dry but for a particle, far away.
template <int Dim>
auto dry_tank(const std::vector<mps::FloatingBody<Dim>>& bodies, const Vec<Dim>& gravity) {
  mps::FlowSettings<Dim, mps::Recommended> settings{
      .spacing = l0, .gravity = gravity, .speed_scale = 2};
  const Vec<Dim> upper = Vec<Dim>::Constant(2.0);
  if constexpr (Dim == 2) {
    settings.walls.segments = polyline({{0, 2}, {0, 0}, {0.7, 0}, {2, 0}, upper});
    settings.walls.moving_2d = mps::MovingWalls<2>{.bodies = bodies};
  } else {
    settings.walls.triangles = faces_of(Box<3>{.lower = {0, 0, 0}, .upper = upper});
    settings.walls.moving_3d = mps::MovingWalls<3>{.bodies = bodies};
  }
  mps::Fluid<Dim> fluid;
  mps::add_particle(fluid, Vec<Dim>(Vec<Dim>::Constant(2 - l0 / 2)), mps::Kind::fluid);
  return Simulation{fluid, UniformGrid<Dim>{}, mps::Flow<mps::Recommended, Dim>{settings},
                    SemiImplicit<>{}};
}

template <int Dim>
void expect_volume_and_edges() {
  const Vec<Dim> centre = Vec<Dim>::Constant(0.3);
  for (const double edge : {0.1, 0.03, 0.012}) {
    const auto faces = faces_of_ball<Dim>(centre, edge);
    const auto mass = mass_properties_of<Dim>("ball", faces, 1000);  // throws unless closed
    const double volume = Dim == 2 ? std::numbers::pi * squared(radius)
                                   : 4 * std::numbers::pi / 3 * std::pow(radius, 3);
    EXPECT_NEAR(mass.mass, 1000 * volume, 1e-9 * volume);
    EXPECT_LT((mass.centre - centre).norm(), 1e-12);
    double longest = 0;
    for (const Face<Dim>& face : faces) {
      longest = std::max(longest, (face.corners[1] - face.corners[0]).norm());
      EXPECT_GT(normal_of(face).dot(face.corners[0] - centre), 0.9 * radius);
    }
    EXPECT_LT(longest, 1.1 * edge);
    EXPECT_GT(longest, 0.5 * edge);
  }
}
TEST(RoundBodies, HaveTheVolumeOfADiscOrASphere) {
  expect_volume_and_edges<2>();
  expect_volume_and_edges<3>();
}
TEST(RoundBodies, RefuseFacesThatAreNone) {
  EXPECT_TRUE(refuses([] { faces_of_disc({0, 0}, 0, 0.1); }, {"faces_of_disc: radius", "0"}));
  EXPECT_TRUE(refuses([] { faces_of_sphere({0, 0, 0}, 1, -1); }, {"faces_of_sphere: edge", "-1"}));
  EXPECT_TRUE(refuses([] { faces_of_sphere({0, 0, 0}, 1, 1e-9); }, {"edge = 1e-09 m", "longer"}));
  EXPECT_TRUE(refuses([] { faces_of_disc({std::nan(""), 0}, 1, 1); }, {"centre", "nan"}));
}

// One rolls down a slope as a disc or a sphere does, (2/3) or (5/7) of g sin α, and not as its
// faces, of which it would tumble from one to the next.
template <int Dim>
void expect_rolling() {
  const double alpha = 0.2;
  const Vec<Dim> up = Vec<Dim>::Unit(Dim - 1), ahead = Vec<Dim>::Unit(0);
  const Vec<Dim> gravity = g * (std::sin(alpha) * ahead - std::cos(alpha) * up);
  Vec<Dim> centre = Vec<Dim>::Constant(0.3);
  centre[Dim - 1] = radius + l0;
  auto sim = dry_tank<Dim>(
      {{.faces = faces_of_ball(centre), .density = 2000, .radius = radius, .friction = 0.8}},
      gravity);
  const mps::BodyInFlow<Dim>& ball = sim.interaction().walls().bodies()[0];
  double off = 0;
  while (sim.time() < 0.6) {
    sim.step();
    off = std::max(off, std::abs(ball.state().position[Dim - 1] - centre[Dim - 1]));
  }
  EXPECT_LT(off, 1e-6 * l0);
  // The point of contact is in the middle of the spacing between both.
  const double arm = radius + l0 / 2, share = Dim == 2 ? 0.5 : 0.4;
  const double acceleration = g * std::sin(alpha) / (1 + share * squared(radius / arm));
  EXPECT_NEAR(ball.state().position[0] - centre[0], acceleration * squared(sim.time()) / 2,
              0.02 * acceleration * squared(sim.time()) / 2);
}
TEST(RoundBodies, RollAsADiscAndASphere) {
  expect_rolling<2>();
  expect_rolling<3>();
}

// The line of contact of two goes through both centres, so that a collision without friction gives
// no spin; a corner of a box is kept off the shape, not off the faces.
template <int Dim>
void expect_collisions() {
  const Vec<Dim> middle = Vec<Dim>::Constant(1.0);
  Vec<Dim> start = middle;
  start[0] -= 0.3;
  start[1] += 0.13;
  const Vec<Dim> ahead = Vec<Dim>::Unit(0);
  auto sim = dry_tank<Dim>(
      {{.faces = faces_of_ball(middle), .density = 2000, .radius = radius},
       {.faces = faces_of_ball(start), .density = 900, .velocity = 2 * ahead, .radius = radius}},
      Vec<Dim>(Vec<Dim>::Zero()));
  const auto& bodies = sim.interaction().walls().bodies();
  double closest = std::numeric_limits<double>::infinity();
  while (sim.time() < 0.3) {
    sim.step();
    closest = std::min(closest, (bodies[0].state().position - bodies[1].state().position).norm());
  }
  EXPECT_NEAR(closest, 2 * radius + l0, 1e-3 * l0);
  EXPECT_GT(bodies[0].state().velocity[0], 0.1);
  for (const auto& body : bodies) {
    EXPECT_LT(std::sqrt(squared_norm(body.state().spin)), 1e-10);
  }

  Vec<Dim> lower = middle;
  lower[0] += 0.1;
  const Vec<Dim> corner = lower;  // of a box that does not move
  const Box<Dim> box{.lower = lower, .upper = lower + Vec<Dim>(Vec<Dim>::Constant(0.2))};
  std::array<bool, std::size_t(Dim)> held;
  held.fill(true);
  start = corner - Vec<Dim>(Vec<Dim>::Constant(0.12));
  start[0] -= 0.02;
  auto other = dry_tank<Dim>(
      {{.faces = faces_of(box), .density = 2000, .is_held = held, .keeps_orientation = true},
       {.faces = faces_of_ball(start),
        .density = 900,
        .velocity = Vec<Dim>::Constant(1.0),
        .radius = radius}},
      Vec<Dim>(Vec<Dim>::Zero()));
  const auto& ball = other.interaction().walls().bodies()[1];
  closest = std::numeric_limits<double>::infinity();
  while (other.time() < 0.2) {
    other.step();
    closest = std::min(closest, (ball.state().position - corner).norm());
  }
  EXPECT_NEAR(closest, radius + l0, 1e-3 * l0);
}
TEST(RoundBodies, MeetEachOtherAndCornersByTheirShape) {
  expect_collisions<2>();
  expect_collisions<3>();
}

TEST(RoundBodies, AreToldApartFromTheirFaces) {
  const auto sum = [](double of_shape, double mu) {
    return mps::ImageWalls{
        .moving_2d = mps::MovingWalls<2>{.bodies = {{.faces = faces_of_disc({0, 0}, 0.3, 0.1),
                                                     .density = 500,
                                                     .radius = of_shape,
                                                     .friction = mu}}}}
        .checksum();
  };
  EXPECT_NE(sum(0.3, 0), sum(0, 0));
  EXPECT_NE(sum(0.3, 0), sum(0, 0.3));
}
TEST(RoundBodies, RefuseOtherShapes) {
  const auto run = [](const mps::FloatingBody<2>& body) { dry_tank<2>({body}, {0, -g}).step(); };
  const auto box = polyline({{0.2, 0.2}, {0.4, 0.2}, {0.4, 0.4}, {0.2, 0.4}, {0.2, 0.2}});
  const auto disc = faces_of_disc({0.3, 0.3}, radius, 0.05);
  EXPECT_TRUE(refuses([&] { run({.faces = box, .density = 500, .radius = radius}); },
                      {"body 0: radius = 0.1 m", "of a radius of 0.112838 m", "faces_of_disc()"}));
  const double half = radius * std::sqrt(std::numbers::pi) / 2;  // of the same area
  const auto as_large = faces_of(Box<2>{{0.3 - half, 0.3 - half}, {0.3 + half, 0.3 + half}});
  EXPECT_TRUE(refuses([&] { run({.faces = as_large, .density = 500, .radius = radius}); },
                      {"body 0: radius = 0.1 m", "0.125", "faces_of_disc()"}));
  const auto on_floor = faces_of_disc({0.3, radius}, radius, 0.05);
  EXPECT_TRUE(refuses([&] { run({.faces = on_floor, .density = 500, .radius = radius}); },
                      {"body 0", "away from its radius", "begin a spacing away"}));
  EXPECT_TRUE(refuses([&] { run({.faces = disc, .density = 500, .radius = -1}); },
                      {"body 0: radius", "-1"}));
  EXPECT_TRUE(refuses([&] { run({.faces = disc, .density = 500, .radius = std::nan("")}); },
                      {"body 0: radius", "nan"}));
  const auto large = faces_of_disc({1, 1}, 0.6, 0.6);
  EXPECT_TRUE(refuses([&] { run({.faces = large, .density = 500, .radius = 0.6}); },
                      {"body 0: its faces are up to", "a quarter of the spacing = 0.02"}));
}

}  // namespace
}  // namespace silt::test::round_bodies_test
