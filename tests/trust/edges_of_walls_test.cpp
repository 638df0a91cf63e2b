// SPDX-License-Identifier: MIT
// Grains whose centre is exactly on a wall, an edge, a corner or an axis, or so close to it that
// squares of the distance underflow: they have at least one contact, with a unit normal.
// Only with --all: every wall at its edges.
#include <silt/dem.hpp>
#include <silt/dem/wall/mesh/mesh_wall.hpp>
#include <silt/dem/wall/walls.hpp>

#include "support/any_wall.hpp"
#include "support/check.hpp"
#include "support/grains.hpp"
#include "support/triangles.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace silt::test::edges_of_walls_test {
namespace {

constexpr double R = 0.1;
constexpr double stiffness = 1;

// A grain at x touches the wall, with unit normals, and the force on it is that of its contacts.
template <int Dim>
void expect_contact_at(const AnyWall<Dim>& wall, const Vec<Dim>& x, const std::string& what) {
  Vec<Dim> expected = Vec<Dim>::Zero();
  Index touching = 0;
  wall.for_each_element_near(x, R, [&](Index element) {
    const auto at = wall.nearest(element, x);
    if (!(at.distance < R)) {
      EXPECT_EQ(at.distance, at.distance) << what << ": NaN";
      return;
    }
    EXPECT_NEAR(at.normal.norm(), 1, 1e-12) << what << ", element " << element;
    expected += stiffness * (R - at.distance) * at.normal;
    ++touching;
  });
  EXPECT_GE(touching, 1u) << what;
  Simulation sim{
      one_grain<Dim>(x, Vec<Dim>(Vec<Dim>::Zero()), {.radius = R, .density = 1}), BruteForce<Dim>{},
      dem::Contacts{dem::CundallStrack{.normal_stiffness = stiffness}, wall}.with(without_limits),
      Leapfrog{}};
  sim.step(1e-6);
  EXPECT_EQ(sim.interaction().size(), touching) << what;
  const Vec<Dim> F = sim.particles()[force][0];
  EXPECT_TRUE(is_finite(F)) << what;
  EXPECT_LT((F - expected).norm(), 1e-15) << what;
}

// At these points, and at distances from them down to the smallest number.
template <int Dim, class W>
void expect_contacts(const W& wall, const std::vector<Vec<Dim>>& points, const std::string& name) {
  const AnyWall<Dim> any(wall);
  for (const Vec<Dim>& point : points) {
    const std::string at = name + " at " + to_text(point);
    expect_contact_at<Dim>(any, point, at);
    for (const double size :
         {1e-3, 1e-12, 1e-100, 1e-153, 1e-154, 1e-158, 1e-161, 1e-162, 1e-200, 5e-324}) {
      for (int direction = 0; direction < 9; ++direction) {
        Vec<Dim> off;
        off[0] = (direction % 3 - 1) * size;
        off[1] = (direction / 3 - 1) * size;
        if constexpr (Dim == 3) off[2] = (direction % 2) * 0.75 * size;
        expect_contact_at<Dim>(
            any, point + off,
            at + " + " + to_text(size) + " direction " + std::to_string(direction));
      }
    }
  }
}

TEST(CentreOnAWall, HasAContactIn2D) {
  expect_contacts<2>(dem::Plane<2>{}, {{0, 0}, {3, 0}}, "Plane");
  for (const auto side : {dem::Side::inside, dem::Side::outside}) {
    expect_contacts<2>(dem::Circle<>{.radius = 0.05, .grains = side}, {{0, 0}, {0.05, 0}},
                       "Circle");
    expect_contacts<2>(
        dem::BoxWall<2>{.box = {.lower = {0, 0}, .upper = {0.1, 0.2}}, .grains = side},
        {{0, 0}, {0.1, 0.2}, {0.05, 0}, {0.05, 0.1}, {0, 0.2}}, "BoxWall");
  }
  expect_contacts<2>(dem::Segment<>{.from = {0, 0}, .to = {1, 0}}, {{0, 0}, {0.5, 0}, {1, 0}},
                     "Segment");
  const std::vector<Vec<2>> corners{{0, 0}, {1, 0}, {1, 1}, {0.5, 0.5}};
  for (const bool closed : {false, true}) {
    auto points = corners;
    points.push_back({0.5, 0});
    expect_contacts<2>(dem::Polyline<>{.points = corners, .closed = closed}, points, "Polyline");
  }
  // One that turns back.
  expect_contacts<2>(dem::Polyline<>{.points = {{0, 0}, {1, 0}, {0.5, 0}}}, {{1, 0}, {0.5, 0}},
                     "Polyline");
}

TEST(CentreOnAWall, HasAContactIn3D) {
  expect_contacts<3>(dem::Plane<3>{.normal = {1, 2, 3}}, {{0, 0, 0}, {3, 0, -1}}, "Plane");
  for (const auto side : {dem::Side::inside, dem::Side::outside}) {
    for (const bool ends : {false, true}) {
      expect_contacts<3>(dem::Cylinder<>{.radius = 0.05, .grains = side, .ends = ends},
                         {{0, 0, 0.5}, {0, 0, 0}, {0, 0, 1}, {0.05, 0, 0.5}, {0, 0.05, 0}},
                         "Cylinder");
    }
    const Box<3> box{.lower = {0, 0, 0}, .upper = {0.1, 0.2, 0.3}};
    expect_contacts<3>(dem::BoxWall<3>{.box = box, .grains = side},
                       {{0, 0, 0}, {0.1, 0.2, 0.3}, {0.05, 0, 0}, {0.05, 0.1, 0}, {0, 0.2, 0.3}},
                       "BoxWall");
  }
}

TEST(CentreOnAWall, OfTrianglesHasAContact) {
  const Box<3> box{.lower = {0, 0, 0}, .upper = {1, 1, 1}};
  const std::vector<Vec<3>> points{{0, 0, 0},       {1, 1, 1},     {0.5, 0, 0},  {0, 0.5, 0},
                                   {0.25, 0.75, 0}, {0.5, 0.5, 0}, {0.5, 0.5, 1}};
  for (const int n : {1, 2}) {
    expect_contacts<3>(dem::MeshWall<>(box_of_triangles(box, n)), points, "box");
  }
  Triangles one;
  one.push_back({{Vec<3>(0, 0, 0), Vec<3>(1, 0, 0), Vec<3>(0, 1, 0)}});
  expect_contacts<3>(dem::MeshWall<>(one),
                     {{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}, {0.5, 0.5, 0}, {0.25, 0.25, 0}},
                     "triangle");
}

}  // namespace
}  // namespace silt::test::edges_of_walls_test
