// SPDX-License-Identifier: MIT
#include <silt/geometry/nearby_faces.hpp>
#include <silt/geometry/shapes.hpp>

#include "support/points.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace silt::test::nearby_faces_test {
namespace {

template <int Dim>
NearbyFaces<Dim> around(const Faces<Dim>& faces, const Vec<Dim>& x, double reach) {
  NearbyFaces<Dim> found;
  found.find(faces, x, reach);
  return found;
}
template <int Dim>
Faces<Dim> random_faces(Index n, unsigned seed) {
  const auto centres = random_points(n, cube<Dim>(-2.0, 2.0), seed);
  const auto corners = random_points(n * Index(Dim), cube<Dim>(-0.5, 0.5), seed + 1);
  std::vector<Face<Dim>> faces(n);
  for (Index k = 0; k < corners.size(); ++k) {
    faces[k / Index(Dim)].corners[k % Index(Dim)] = centres[k / Index(Dim)] + corners[k];
  }
  return Faces<Dim>("faces", faces);
}
template <int Dim>
double distance_of(const Face<Dim>& face, const Vec<Dim>& x) {
  return (nearest_of(face, x) - x).norm();
}

template <int Dim>
void expect_those_of_brute_force(double reach) {
  const Faces<Dim> faces = random_faces<Dim>(60, 1);
  std::vector<std::uint32_t> all(faces.elements().size());
  std::iota(all.begin(), all.end(), 0u);
  const auto points = random_points(100, cube<Dim>(-3.0, 3.0), 3);
  std::vector<NearbyFaces<Dim>> together(points.size());
  NearbyFaces<Dim>::find_all(faces, std::span<const Vec<Dim>>(points), reach,
                             std::span<NearbyFaces<Dim>>(together));
  for (Index i = 0; i < points.size(); ++i) {
    const auto found = around(faces, points[i], reach);
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t k : all) {
      const double distance = distance_of(faces[k].face, points[i]);
      least = std::min(least, distance);
      EXPECT_EQ(std::ranges::count(found.faces(), k), distance < found.furthest()) << distance;
    }
    EXPECT_EQ(found.empty(), found.faces().empty());
    if (least < reach) {
      EXPECT_DOUBLE_EQ(found.distance(), least);
    } else if (found.empty()) {
      EXPECT_EQ(found.distance(), std::numeric_limits<double>::infinity());
    }
    NearbyFaces<Dim> among;
    among.find(faces, points[i], reach, all);
    EXPECT_TRUE(std::ranges::equal(among.faces(), found.faces()));
    EXPECT_TRUE(std::ranges::equal(together[i].faces(), found.faces()));
    EXPECT_EQ(together[i].distance(), found.distance());
  }
}

// Also of several points, with few and with many faces in common.
TEST(NearbyFaces, AreThoseOfBruteForce) {
  for (const double reach : {0.1, 1.0, 9.0}) {
    expect_those_of_brute_force<2>(reach);
    expect_those_of_brute_force<3>(reach);
  }
  const Faces<2> few("few", polyline({{-1, 0}, {0, 0}, {0, 1}}));
  const std::vector<Vec<2>> points{{0.5, 0.5}, {-0.5, -0.5}, {5, 5}};
  std::vector<NearbyFaces<2>> together(points.size());
  NearbyFaces<2>::find_all(few, std::span<const Vec<2>>(points), 1, std::span(together));
  EXPECT_EQ(together[0].faces().size(), 2);
  EXPECT_EQ(together[1].faces().size(), 2);
  EXPECT_TRUE(together[2].empty());
}

TEST(NearbyFaces, FormFacets) {
  const Faces<3> cube("cube", faces_of(Box<3>{.lower = {0, 0, 0}, .upper = {2, 2, 2}}));
  const auto found = around<3>(cube, {0.5, 0.5, 0.5}, 1);
  ASSERT_EQ(found.facets().size(), 3);
  for (const auto& facet : found.facets()) {
    EXPECT_EQ(found.faces_of(facet).size(), 2);
    EXPECT_DOUBLE_EQ(std::abs(facet.height({0.5, 0.5, 0.5})), 0.5);
    for (const std::uint32_t k : found.faces_of(facet)) {
      for (const Vec<3>& corner : found[k].face.corners) EXPECT_EQ(facet.height(corner), 0);
    }
  }
}

TEST(NearbyFaces, ArePlaneOnlyAwayFromItsRim) {
  const Faces<3> cube("cube", faces_of(Box<3>{.lower = {0, 0, 0}, .upper = {9, 9, 9}}));
  EXPECT_TRUE(around<3>(cube, {4, 4, 1}, 2).is_plane());  // above the edge of two triangles
  EXPECT_FALSE(around<3>(cube, {1, 4, 1}, 2).is_plane());
  EXPECT_FALSE(around<3>(cube, {4, 4, 4}, 2).is_plane());  // nothing
  const Faces<2> wall("wall", polyline({{0, 0}, {9, 0}}));
  EXPECT_TRUE(around<2>(wall, {4, 1}, 2).is_plane());
  EXPECT_FALSE(around<2>(wall, {8, 1}, 2).is_plane());
}

TEST(NearbyFaces, KnowWhetherAllAnglesAreRight) {
  for (const double angle : {0.0, 0.3, 1.0}) {
    const Vec<2> one(std::cos(angle), std::sin(angle)), other(-one[1], one[0]);
    const Faces<2> corner("corner", polyline({one, {0, 0}, other, one + other}));
    EXPECT_TRUE(around<2>(corner, 0.5 * one + 0.5 * other, 2).has_right_angles_only());
    const Faces<2> acute("acute", polyline({one, {0, 0}, one + other}));
    EXPECT_FALSE(around<2>(acute, 0.5 * one + 0.2 * other, 2).has_right_angles_only());
  }
}

std::vector<std::pair<double, double>> planes_below(const Faces<3>& faces, const Vec<3>& x) {
  std::vector<std::pair<double, double>> found;
  around(faces, x, 3).for_each_plane_below([&](const Vec<3>& normal, double height, std::uint32_t) {
    const Vec<3> below = x - height * normal;
    double distance = std::numeric_limits<double>::infinity();
    for (const auto& element : faces.elements()) {
      distance = std::min(distance, distance_of(element.face, below));
    }
    found.push_back({height, distance});
  });
  std::ranges::sort(found);
  return found;
}

// Of the two triangles of each side, where x is above both of them, too.
TEST(NearbyFaces, HaveAPlaneBelowForEverySideOfACubeThatAPointIsAbove) {
  const Faces<3> cube("cube", faces_of(Box<3>{.lower = {0, 0, 0}, .upper = {2, 2, 2}}));
  const auto inside = planes_below(cube, {1, 1, 1});
  ASSERT_EQ(inside.size(), 6);
  for (const auto& [height, distance] : inside) {
    EXPECT_DOUBLE_EQ(height, 1);
    EXPECT_NEAR(distance, 0, 1e-15);
  }
  EXPECT_EQ(planes_below(cube, {1, 0.5, 3}).size(), 2);  // from the outside: top and bottom
  EXPECT_EQ(planes_below(cube, {2.5, 1, 3}).size(), 0);  // beyond an edge
}

TEST(MovesNearFaces, ContinueAlongAWallAtAnyAngle) {
  for (double angle = 0; angle < 6; angle += 0.37) {
    const Vec<2> along(std::cos(angle), std::sin(angle)), up(-along[1], along[0]);
    const Faces<2> wall("wall", polyline({-5 * along, 5 * along}));
    const auto found = around<2>(wall, 0.5 * up, 2);
    const auto expect_end = [&](const Vec<2>& move, const Vec<2>& end) {
      EXPECT_NEAR((0.5 * up + found.before_faces(move, 0.1) - end).norm(), 0, 1e-14) << angle;
    };
    expect_end(0.3 * along - 0.2 * up, 0.3 * along + 0.3 * up);
    expect_end(0.3 * along - 0.45 * up, 0.3 * along + 0.1 * up);  // too close
    expect_end(0.3 * along - 1.0 * up, 0.3 * along + 0.1 * up);   // through the wall
    const auto close = around<2>(wall, 0.01 * up, 2);  // closer than the clearance
    EXPECT_NEAR((close.before_faces(0.3 * along - up, 0.1) - 0.3 * along).norm(), 0, 1e-14);
  }
}

TEST(MovesNearFaces, EndInACornerOfACube) {
  const Faces<3> cube("cube", faces_of(Box<3>{.lower = {0, 0, 0}, .upper = {2, 2, 2}}));
  const Vec<3> x(0.5, 0.4, 0.3);
  const Vec<3> end = x + around(cube, x, 2).before_faces({-0.6, -0.6, -0.6}, 0.1);
  EXPECT_NEAR((end - Vec<3>(0.1, 0.1, 0.1)).norm(), 0, 1e-14);
}

TEST(MovesNearFaces, AreZeroWhereFacesLeaveNone) {
  const Faces<2> wedge("wedge", polyline({{9, 0}, {0, 0}, {9, 1}}));
  EXPECT_EQ(around<2>(wedge, {2, 0.12}, 2).before_faces({-1, 0}, 0.1), (Vec<2>(0, 0)));
}

// The clearance is then that of the point itself.
TEST(MovesNearFaces, GoOnInASlitNarrowerThanTwoClearances) {
  const Faces<2> slit("slit", polyline({{0, 1}, {0, 0}, {0.15, 0}, {0.15, 1}}));
  const Vec<2> kept = around<2>(slit, {0.07, 0.5}, 2).before_faces({0, -0.7}, 0.1);
  EXPECT_NEAR((kept - Vec<2>(0, -0.4)).norm(), 0, 1e-14);
}

template <int Dim>
void expect_free_moves() {
  const Faces<Dim> faces = random_faces<Dim>(40, 4);
  const auto points = random_points(5000, cube<Dim>(-2.0, 2.0), 6);
  const auto moves = random_points(5000, cube<Dim>(-0.5, 0.5), 7);
  int changed = 0;
  for (Index k = 0; k < points.size(); ++k) {
    const Vec<Dim>& x = points[k];
    const Vec<Dim> kept = around(faces, x, 1).before_faces(moves[k], 0.05);
    changed += kept != moves[k];
    if (kept.norm() == 0) continue;
    const Vec<Dim> end = x + kept;
    for (const auto& element : faces.elements()) {
      const double least = std::min(0.05, distance_of(element.face, x));
      EXPECT_GE(distance_of(element.face, end), (1 - 1e-8) * least) << k;
      EXPECT_FALSE((element.height(x) > 0) != (element.height(end) > 0) &&
                   passage_of(element.face, x, end, 0) == Passage::through) << k;
    }
  }
  EXPECT_GT(changed, 100);
}

TEST(MovesNearFaces, EndBeforeRandomFaces) {
  expect_free_moves<2>();
  expect_free_moves<3>();
}

}  // namespace
}  // namespace silt::test::nearby_faces_test
