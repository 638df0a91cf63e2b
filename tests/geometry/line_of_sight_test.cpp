// SPDX-License-Identifier: MIT
#include <silt/geometry/line_of_sight.hpp>
#include <silt/geometry/shapes.hpp>

#include "support/points.hpp"
#include <gtest/gtest.h>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace silt::test::line_of_sight_test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

template <int Dim>
std::vector<Direction> all_directions() {
  std::vector<Direction> directions;
  for (int axis = 0; axis < Dim; ++axis) {
    for (const int sign : {-1, 1}) directions.push_back({axis, sign});
  }
  return directions;
}

template <int Dim>
std::vector<Face<Dim>> random_faces(Index n, unsigned seed) {
  const auto corners = random_points(n * Index(Dim), cube<Dim>(-2.0, 2.0), seed);
  std::vector<Face<Dim>> faces(n);
  for (Index k = 0; k < corners.size(); ++k) {
    faces[k / Index(Dim)].corners[k % Index(Dim)] = corners[k];
  }
  return faces;
}

// From the shares of the corners in the point of the plane that the line meets.
template <int Dim>
double distance_by_solving(const Face<Dim>& face, const Vec<Dim>& x, const Direction& direction) {
  Eigen::Matrix<double, Dim, Dim> columns;
  for (int k = 1; k < Dim; ++k) columns.col(k) = face.corners[std::size_t(k)] - face.corners[0];
  columns.col(0) = -direction.sign * Vec<Dim>::Unit(direction.axis);
  const Vec<Dim> solution = columns.partialPivLu().solve(x - face.corners[0]);
  double share_of_first = 1;
  for (int k = 1; k < Dim; ++k) {
    if (solution[k] < 0) return infinity;
    share_of_first -= solution[k];
  }
  return share_of_first < 0 || solution[0] < 0 ? infinity : solution[0];
}

template <int Dim>
void expect_same_as_by_solving(bool counts_back_sides) {
  const auto list = random_faces<Dim>(30, 1);
  const Faces<Dim> faces("faces", list);
  int seen = 0;
  for (const Vec<Dim>& x : random_points(200, cube<Dim>(-2.0, 2.0), 2)) {
    for (const Direction& direction : all_directions<Dim>()) {
      double expected = infinity;
      for (const Face<Dim>& face : list) {
        if (!counts_back_sides && normal_of(face)[direction.axis] * direction.sign > 0) continue;
        expected = std::min(expected, distance_by_solving(face, x, direction));
      }
      const double distance = first_face(faces, x, direction, counts_back_sides).distance;
      if (expected == infinity) {
        EXPECT_EQ(distance, infinity) << x.transpose();
      } else {
        EXPECT_NEAR(distance, expected, 1e-9) << x.transpose();
        ++seen;
      }
    }
  }
  EXPECT_GT(seen, 200);
}

TEST(DistanceToFace, IsTheSameAsByBruteForce) {
  for (const bool counts_back_sides : {true, false}) {
    expect_same_as_by_solving<2>(counts_back_sides);
    expect_same_as_by_solving<3>(counts_back_sides);
  }
}

TEST(DistanceToFace, IsThatOfTheSideOfABox) {
  const Box<3> box{.lower = {-1, 0, 2}, .upper = {3, 5, 4}};
  const Faces<3> faces("box", faces_of(box));
  for (const Vec<3>& x : random_points(100, box, 3)) {
    for (const Direction& direction : all_directions<3>()) {
      const auto [axis, sign] = direction;
      const double expected = sign > 0 ? box.upper[axis] - x[axis] : x[axis] - box.lower[axis];
      EXPECT_NEAR(first_face(faces, x, direction).distance, expected, 1e-14);
      EXPECT_NEAR(first_face(faces, x, direction, false).distance, expected, 1e-14);
    }
  }
}

TEST(DistanceToFace, IsThatAlongTheAxisToAnObliqueFace) {
  const Faces<2> slope("slope", polyline({{0, 0}, {4, 2}}));
  EXPECT_DOUBLE_EQ(first_face<2>(slope, {2, 3}, {1, -1}).distance, 2);
  EXPECT_DOUBLE_EQ(first_face<2>(slope, {0, 1}, {0, 1}).distance, 2);
  const Faces<3> triangle("triangle", {{{Vec<3>(3, 0, 0), {0, 3, 0}, {0, 0, 3}}}});
  EXPECT_DOUBLE_EQ(first_face<3>(triangle, {1, 0.5, 0}, {2, 1}).distance, 1.5);
  EXPECT_DOUBLE_EQ(first_face<3>(triangle, {1, 0.5, 4}, {2, -1}).distance, 2.5);
}

TEST(DistanceToFace, IsInfiniteWhereNoFaceIsAhead) {
  EXPECT_EQ(first_face<2>(Faces<2>(), {0, 0}, {0, 1}).distance, infinity);
  const Faces<2> step("step", polyline({{0, 0}, {2, 0}, {2, 1}}));
  EXPECT_EQ(first_face<2>(step, {1, 0.5}, {1, 1}).distance, infinity);      // behind
  EXPECT_EQ(first_face<2>(step, {-0.1, 0.5}, {1, -1}).distance, infinity);  // beside
  EXPECT_EQ(first_face<2>(step, {-1, 0}, {0, 1}).distance, 3);  // along one face, to the other
  EXPECT_EQ(first_face<2>(step, {0, 1.1}, {0, 1}).distance, infinity);
  EXPECT_EQ(first_face<2>(step, {0, 1}, {0, 1}).distance, 2);  // touches the end
}

// Normals of a box point into it: from the outside, the near side is a back side.
TEST(DistanceToFace, PassesThroughBackSidesThatDoNotCount) {
  const Faces<3> faces("box", faces_of(Box<3>{.lower = {0, 0, 0}, .upper = {2, 2, 2}}));
  EXPECT_DOUBLE_EQ(first_face<3>(faces, {-1, 0.5, 0.7}, {0, 1}).distance, 1);
  EXPECT_DOUBLE_EQ(first_face<3>(faces, {-1, 0.5, 0.7}, {0, 1}, false).distance, 3);
}

TEST(DistanceToFace, KnowsTheTwoSidesOfAThinPlate) {
  constexpr double thickness = 1e-9;
  const Faces<2> plate("plate", polyline({{0, -1}, {0, 1}, {thickness, 1}, {thickness, -1}}));
  EXPECT_DOUBLE_EQ(first_face<2>(plate, {-0.25, 0}, {0, 1}).distance, 0.25);
  EXPECT_DOUBLE_EQ(first_face<2>(plate, {0.25, 0}, {0, -1}).distance, 0.25 - thickness);
  EXPECT_NEAR(first_face<2>(plate, {thickness / 4, 0}, {0, 1}).distance, 0.75 * thickness, 1e-24);
}

// Pairs of triangles at any angle, and lines to points of their common edge, rounded, and its ends.
TEST(DistanceToFace, IsFiniteWhereALineMeetsACommonEdge) {
  const auto corners = random_points(400, cube<3>(-2.0, 2.0), 4);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (Index k = 0; k + 3 < corners.size(); k += 4) {
    const Vec<3>&a = corners[k], &b = corners[k + 1];
    Vec<3> left = corners[k + 2], right = corners[k + 3];
    // Seen along x, on two sides of the edge.
    const auto side = [&](const Vec<3>& c) {
      return (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]);
    };
    if (side(left) * side(right) > 0) right = a + b - right;
    const Faces<3> faces("pair", {{{a, b, left}}, {{b, a, right}}});
    for (const double share : {0.0, unit(random), unit(random), 1.0}) {
      Vec<3> x = share == 1 ? b : Vec<3>(a + share * (b - a));
      x[0] -= 5;
      EXPECT_NEAR(first_face(faces, x, {0, 1}).distance, 5, 1e-9) << k << ", " << share;
    }
  }
}

}  // namespace
}  // namespace silt::test::line_of_sight_test
