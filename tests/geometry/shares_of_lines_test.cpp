// SPDX-License-Identifier: MIT
#include <silt/geometry/shapes.hpp>
#include <silt/geometry/shares_of_lines.hpp>

#include "support/ball.hpp"
#include "support/points.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace silt::test::shares_of_lines_test {
namespace {

constexpr double reach = 3;

template <int Dim>
double share(const Faces<Dim>& faces, const Vec<Dim>& x, const Vec<Dim>& point,
             const Mirror<Dim>& mirror = {}) {
  NearbyFaces<Dim> around;
  around.find(faces, x, reach);
  EXPECT_FALSE(around.is_plane());
  return SharesOfLines<Dim>(around).of(point, mirror);
}
template <int Dim>
Mirror<Dim> mirror_of(const Faces<Dim>& faces, std::uint32_t face) {
  return mirror_in<Dim>(faces[face].normal, faces[face].offset);
}

// Random faces, 1 unless the line passes through one of them; less certain only where it is closer
// to an end of a face than other lines for the share are to it.
TEST(SharesOfLines, AreThoseOfBruteForceAwayFromEnds) {
  const auto ends = random_points(60, cube<2>(-4.0, 4.0), 1);
  std::vector<Face<2>> list;
  for (Index k = 0; k < ends.size(); k += 2) list.push_back({{ends[k], ends[k + 1]}});
  const Faces<2> faces("faces", list);
  int seen = 0, hidden = 0;
  const auto points = random_points(2000, cube<2>(-4.0, 4.0), 2);
  for (Index k = 0; k < points.size(); k += 2) {
    const Vec<2>&x = points[k], &point = points[k + 1];
    if (!((x - point).norm() < reach)) continue;
    const bool is_certain = std::ranges::all_of(ends, [&](const Vec<2>& end) {
      const Vec<2> nearest = nearest_of_segment<2>(x, point, end);
      return (nearest - end).norm() > 0.05 * reach;
    });
    const double found = share(faces, x, point);
    EXPECT_TRUE(found >= 0 && found <= 1);
    if (!is_certain) continue;
    const bool is_hidden = std::ranges::any_of(faces.elements(), [&](const auto& element) {
      return (element.height(x) > 0) != (element.height(point) > 0) &&
             passage_of(element.face, x, point, 0) == Passage::through;
    });
    EXPECT_EQ(found, is_hidden ? 0 : 1) << x.transpose() << " to " << point.transpose();
    ++(is_hidden ? hidden : seen);
  }
  EXPECT_GT(seen, 20);
  EXPECT_GT(hidden, 20);
}

TEST(SharesOfLines, AreAllWithoutFaces) {
  EXPECT_EQ(share<2>(Faces<2>(), {0, 0}, {1, 1}), 1);
  EXPECT_EQ(share<3>(Faces<3>(), {0, 0, 0}, {1, 1, 1}), 1);
}

TEST(SharesOfLines, AreHalfInALineWithAnEnd) {
  const Faces<2> wall("wall", polyline({{0, -9}, {0, 0}}));
  EXPECT_EQ(share<2>(wall, {-1, 0}, {1, 0}), 0.5);
  EXPECT_EQ(share<2>(wall, {-1, 0}, {-1, 0}, mirror_of(wall, 0)), 0.5);  // of its own image
  const Faces<3> square("square", {{{Vec<3>(0, -9, -9), {0, 9, -9}, {0, 9, 0}}},
                                   {{Vec<3>(0, -9, -9), {0, 9, 0}, {0, -9, 0}}}});
  EXPECT_EQ(share<3>(square, {-1, 0.1, 0}, {1, 0.3, 0}), 0.5);
}

// In the image of the whole, and in the front of the plate only.
TEST(SharesOfLines, AreOfOneSideOfAThinPlate) {
  constexpr double thickness = 1e-5;
  const Faces<2> plate("plate", polyline({{0, -9}, {0, 0}, {thickness, 0}, {thickness, -9}}));
  for (const double at : {-1.0, 1.0}) {
    const Vec<2> x(at, -2), point(at / 2, -1.5), other(-at, -2);
    EXPECT_EQ(share(plate, x, point), 1);
    EXPECT_EQ(share(plate, x, other), 0);
    EXPECT_EQ(share(plate, x, point, mirror_of(plate, 0)), at < 0);
    EXPECT_EQ(share(plate, x, point, mirror_of(plate, 2)), at > 0);
    EXPECT_EQ(share(plate, x, other, mirror_of(plate, 0)), 0);
  }
}

// What is seen in the direction of one point: the point, or one whose image is there.
template <int Dim>
void expect_sums_of_one(const Faces<Dim>& faces, const std::vector<Mirror<Dim>>& mirrors,
                        const Vec<Dim>& x) {
  int split = 0;
  for (const Vec<Dim>& image : random_points(1000, cube<Dim>(-1.5, 1.5), 3)) {
    double sum = 0;
    bool is_split = false;
    for (const Mirror<Dim>& mirror : mirrors) {
      const double one = share(faces, x, mirror.inverse()(image), mirror);
      is_split = is_split || (one > 0 && one < 1);
      sum += one;
    }
    EXPECT_NEAR(sum, 1, 1e-12) << image.transpose();
    split += is_split;
  }
  EXPECT_GT(split, 10);
}

TEST(SharesOfLines, SumToOneBesideTheEndOfAWall) {
  const Faces<2> wall("wall", polyline({{-5, 0}, {0, 0}}));
  expect_sums_of_one<2>(wall, {{}, mirror_of(wall, 0)}, {0.2, 0.5});
  const Faces<3> triangle("triangle", {{{Vec<3>(-1, -1, 0), {1, -1, 0}, {0, 1, 0}}}});
  expect_sums_of_one<3>(triangle, {{}, mirror_of(triangle, 0)}, {0.2, 0.1, 0.5});
}

TEST(SharesOfLines, SumToOneInAndBesideACorner) {
  const Faces<2> corner("corner", polyline({{0, 0.8}, {0, 0}, {0.9, 0}}));
  const auto one = mirror_of(corner, 0), other = mirror_of(corner, 1);
  for (const Vec<2>& x : {Vec<2>(0.3, 0.4), Vec<2>(-0.3, 0.4), Vec<2>(-0.1, -0.2)}) {
    expect_sums_of_one<2>(corner, {{}, one, other, one.after(other)}, x);
  }
}

// Unless faces are at right angles, images of the lines beside one are not lines beside another.
TEST(SharesOfLines, SumToOneOnAverageInAWedge) {
  const Faces<2> wedge("wedge", polyline({{9, 0}, {0, 0}, {4.5, 9 * std::sqrt(0.75)}}));
  const auto one = mirror_of(wedge, 0), other = mirror_of(wedge, 1);
  const auto both = one.after(other);
  const std::vector<Mirror<2>> mirrors{{}, one, other, both, both.inverse(), both.after(one)};
  const auto images = random_points(1000, cube<2>(-1.4, 1.4), 4);
  double sum = 0;
  for (const Vec<2>& image : images) {
    for (const auto& mirror : mirrors) {
      sum += share<2>(wedge, {0.5, 0.3}, mirror.inverse()(image), mirror);
    }
  }
  EXPECT_NEAR(sum / double(images.size()), 1, 0.005);
}

TEST(SharesOfLines, AreTheSameInBothDirections) {
  const Faces<3> cube_of_faces("cube", faces_of(Box<3>{.lower = {0, 0, 0}, .upper = {1, 1, 1}}));
  const auto points = random_points(600, cube<3>(-0.5, 1.5), 5);
  int split = 0;
  for (Index k = 0; k < points.size(); k += 2) {
    const Vec<3>&x = points[k], &point = points[k + 1];
    for (std::uint32_t face = 0; face < 12; face += 2) {
      const Mirror<3> mirror = mirror_of(cube_of_faces, face);
      for (const Mirror<3>& there : {Mirror<3>{}, mirror}) {
        const double found = share(cube_of_faces, x, point, there);
        EXPECT_EQ(found, share(cube_of_faces, point, x, there.inverse()));
        split += found > 0 && found < 1;
      }
    }
  }
  EXPECT_GT(split, 20);
}

// Of triangles that are sharp, and close to the one point only: no other test has these.
TEST(SharesOfLines, AreTheSameInBothDirectionsBesideABall) {
  const auto walls = ball(4, 12, 24);
  const Faces<3> faces("ball", walls);
  int split = 0;
  const Box<3> around_a_pole{.lower = {-2.5, -2.5, 3.4}, .upper = {2.5, 2.5, 5.5}};
  const auto points = random_points(1200, around_a_pole, 3);
  for (Index k = 0; k + 1 < points.size(); k += 2) {
    const Vec<3>&x = points[k], &point = points[k + 1];
    if (x.norm() < 4.1 || point.norm() < 4.1) continue;
    NearbyFaces<3> around_x, around_point;
    around_x.find(faces, x, reach);
    around_point.find(faces, point, reach);
    if (around_x.is_plane() || around_point.is_plane()) continue;
    for (std::uint32_t face = 0; face < walls.size(); ++face) {
      const Mirror<3> mirror = mirror_of(faces, face);
      if (!((mirror(point) - x).norm() < reach)) continue;
      const double found = SharesOfLines<3>(around_x).of(point, mirror);
      EXPECT_NEAR(found, SharesOfLines<3>(around_point).of(x, mirror), 1e-9);
      split += found > 0 && found < 1;
    }
  }
  EXPECT_GT(split, 20);
}

// No other test proves the derivatives, and that a share is smooth beside an edge.
template <int Dim>
void expect_slopes(const Faces<Dim>& faces, const std::vector<Mirror<Dim>>& mirrors) {
  const double h = 1e-6;
  int split = 0;
  const auto points = random_points(4000, cube<Dim>(-1.1, 1.1), 6);
  for (Index k = 0; k + 1 < points.size(); k += 2) {
    for (const Mirror<Dim>& mirror : mirrors) {
      NearbyFaces<Dim> around;
      around.find(faces, points[k], reach);
      const auto found = SharesOfLines<Dim>(around).share_of(points[k + 1], mirror);
      if (found.slope.isZero()) continue;
      ++split;
      for (int axis = 0; axis < Dim; ++axis) {
        const Vec<Dim> step = h * Vec<Dim>::Unit(axis);
        const auto moved = [&](const Vec<Dim>& of_x, const Vec<Dim>& of_point) {
          return share(faces, Vec<Dim>(points[k] + of_x), Vec<Dim>(points[k + 1] + of_point),
                       mirror);
        };
        const Vec<Dim> zero = Vec<Dim>::Zero();
        const double by_x = (moved(step, zero) - moved(-step, zero)) / (2 * h);
        const double by_point = (moved(zero, step) - moved(zero, -step)) / (2 * h);
        EXPECT_NEAR(found.slope[axis], by_x, 1e-3);
        EXPECT_NEAR((mirror.rotation.transpose() * found.slope_of_image)[axis], by_point, 1e-3);
      }
    }
  }
  EXPECT_GT(split, 20);
}

TEST(SharesOfLines, HaveTheseSlopes) {
  const Faces<2> corner("corner", polyline({{-0.5, 0.8}, {0, 0}, {0.9, 0}}));
  const auto one = mirror_of(corner, 0), other = mirror_of(corner, 1);
  expect_slopes<2>(corner, {{}, one, other, one.after(other)});
  const Faces<3> roof("roof", {{{Vec<3>(-2, 0, 0.3), {2, 0, 0.3}, {0, 2, -0.5}}},
                               {{Vec<3>(-2, 0, 0.3), {2, 0, 0.3}, {0, -2, -0.5}}}});
  const auto left = mirror_of(roof, 0), right = mirror_of(roof, 1);
  expect_slopes<3>(roof, {{}, left, right, left.after(right)});
}

// Past an edge and a corner of a cube.
TEST(SharesOfLines, ChangeInSmallSteps) {
  const Faces<3> cube_of_faces("cube", faces_of(Box<3>{.lower = {0, 0, 0}, .upper = {1, 1, 1}}));
  for (const double height : {0.47, 0.9, 0.93}) {
    const auto seen_at = [&](double y) {
      return share<3>(cube_of_faces, {-0.3, 0.93, height}, {0.313, y, height + 0.07});
    };
    double last = seen_at(0.5);
    EXPECT_LT(last, 1);
    for (double y = 0.5; y < 2; y += 0.0005) {
      const double now = seen_at(y);
      EXPECT_LE(std::abs(now - last), 0.25) << y;
      last = now;
    }
    EXPECT_EQ(last, 1);
  }
}

}  // namespace
}  // namespace silt::test::shares_of_lines_test
