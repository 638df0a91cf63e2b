// SPDX-License-Identifier: MIT
#include <silt/core/lattice.hpp>
#include <silt/geometry/mirrors.hpp>
#include <silt/geometry/shapes.hpp>
#include <silt/geometry/sight.hpp>

#include "support/ball.hpp"
#include "support/check.hpp"
#include "support/points.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

namespace silt::test::mirrors_test {
namespace {

constexpr double reach = 3.1;  // in spacings

// What a point sees of others: points, and their images.
template <int Dim>
struct View {
  double shares = 0;           // of all of them
  std::vector<Vec<Dim>> seen;  // with a share of 1
};
template <int Dim>
View<Dim> view_from(const Faces<Dim>& faces, const Vec<Dim>& x,
                    const std::vector<Vec<Dim>>& points) {
  MirrorsAround<Dim> around;
  around.find(faces, x, reach);
  View<Dim> view;
  const auto add = [&](const Vec<Dim>& at, double share) {
    view.shares += share;
    if (share == 1) view.seen.push_back(at);
  };
  for (const Vec<Dim>& point : points) {
    if (point != x && (point - x).norm() < reach) add(point, around.visible_share(point));
  }
  around.for_each_mirror(points, [&](const Mirror<Dim>& mirror, const auto& share_of, const auto&) {
    for (const Vec<Dim>& point : points) {
      if ((mirror(point) - x).norm() < reach) add(mirror(point), share_of(point));
    }
  });
  return view;
}

// The number of points of the full lattice within the reach.
template <int Dim>
Index points_of_lattice() {
  Index count = 0;
  const Vec<Dim> size = Vec<Dim>::Constant(9);
  for (const auto& x : lattice<Dim>({Vec<Dim>::Zero(), size}, 1.0)) {
    const double r = (x - size / 2).norm();
    count += r > 0 && r < reach;
  }
  return count;
}

template <int Dim>
void expect_full_lattice(const std::vector<Face<Dim>>& walls, const std::vector<Vec<Dim>>& points,
                         double height) {
  const Faces<Dim> faces("walls", walls);
  for (const Vec<Dim>& x : points) {
    if (x[Dim - 1] > height - reach) continue;  // sees above the points
    EXPECT_EQ(view_from(faces, x, points).shares, double(points_of_lattice<Dim>()))
        << x.transpose();
  }
}

TEST(Mirrors, ContinueTheLatticeBeyondTheSidesOfATank) {
  const Box<2> square{.lower = {0, 0}, .upper = {8, 9}};
  expect_full_lattice<2>(faces_of(square, Sides<2>::open()), lattice<2>(square, 1.0), 9);
  const Box<3> cube{.lower = {0, 0, 0}, .upper = {5, 6, 7}};
  expect_full_lattice<3>(faces_of(cube, Sides<3>::open()), lattice<3>(cube, 1.0), 7);
}

// Images of images: the other wall is closer than the reach.
TEST(Mirrors, ContinueTheLatticeBeyondCloseWalls) {
  for (const double width : {1.0, 2.0, 3.0}) {
    const Box<2> channel{.lower = {0, 0}, .upper = {width, 9}};
    expect_full_lattice<2>(faces_of(channel, Sides<2>::open()), lattice<2>(channel, 1.0), 9);
  }
}

TEST(Mirrors, ContinueTheLatticeBeyondConvexCorners) {
  std::vector<Vec<2>> points;
  for (const auto& x : lattice<2>({{0, 0}, {18, 12}}, 1.0)) {
    if (x[0] < 6 || x[0] > 12 || x[1] > 5) points.push_back(x);
  }
  expect_full_lattice<2>(
      polyline({{0, 14}, {0, 0}, {6, 0}, {6, 5}, {12, 5}, {12, 0}, {18, 0}, {18, 14}}), points, 12);
}

TEST(Mirrors, ContinueTheLatticeBeyondABlockInATank) {
  const Box<3> tank{.lower = {0, 0, 0}, .upper = {11, 12, 9}};
  const Box<3> block{.lower = {4, 4, 0}, .upper = {7, 8, 3}};
  std::vector<Vec<3>> points;
  for (const auto& x : lattice<3>(tank, 1.0)) {
    if (!block.contains(x)) points.push_back(x);
  }
  auto walls = faces_of(tank, Sides<3>::open());
  for (const auto& face : faces_of(block)) walls.push_back(face);
  expect_full_lattice<3>(walls, points, 9);
}

// What x sees of each of these neighbours, and of their images: by the number of the neighbour.
template <int Dim>
std::vector<double> seen_from(const MirrorsAround<Dim>& around,
                              const std::vector<Vec<Dim>>& neighbours) {
  std::vector<double> sums;
  for (const Vec<Dim>& point : neighbours) sums.push_back(around.visible_share(point));
  around.for_each_mirror(neighbours,
                         [&](const Mirror<Dim>& mirror, const auto& share_of, const auto&) {
                           for (Index k = 0; k < neighbours.size(); ++k) {
                             const double r = (mirror(neighbours[k]) - around.x()).norm();
                             if (r < reach) sums[k] += share_of(neighbours[k]) * r;
                           }
                         });
  return sums;
}

// Any arrangement, walls at any angle: what x sees is what is seen from each point, and images are
// as far as their points are from the image of x. Otherwise the pressure equation is not symmetric.
// Of the points that are not too close to a wall, as in a flow.
template <int Dim>
void expect_the_same_in_both_directions(const std::vector<Face<Dim>>& walls,
                                        const std::vector<Vec<Dim>>& points) {
  const Faces<Dim> faces("walls", walls);
  std::map<std::pair<Index, Index>, double> seen;
  std::vector<MirrorsAround<Dim>> around(points.size());
  for (Index i = 0; i < points.size(); ++i) around[i].find(faces, points[i], reach);
  const auto counts = [&](Index i) { return around[i].distance() > 0.15; };
  for (Index i = 0; i < points.size(); ++i) {
    if (!counts(i)) continue;
    std::vector<Vec<Dim>> neighbours;
    std::vector<Index> numbers;
    for (Index j = 0; j < points.size(); ++j) {
      if (!counts(j) || !((points[i] - points[j]).norm() < reach)) continue;
      neighbours.push_back(points[j]);
      numbers.push_back(j);
    }
    const auto sums = seen_from(around[i], neighbours);
    for (Index k = 0; k < numbers.size(); ++k) seen[{i, numbers[k]}] = sums[k];
  }
  EXPECT_GT(seen.size(), 1000);
  for (const auto& [pair, sum] : seen) {
    EXPECT_NEAR(sum, seen.at({pair.second, pair.first}), 1e-9)
        << points[pair.first].transpose() << " and " << points[pair.second].transpose();
  }
}

// With points on both sides, and with those in a closed polygon, whose backs are not seen.
TEST(Mirrors, AreTheSameInBothDirections) {
  std::vector<Vec<2>> corners{{0, 0}, {9, 1}, {7, 4}, {10, 8}, {4, 6}, {1, 9}};
  const auto points = random_points(300, Box<2>{.lower = {-1, -1}, .upper = {10, 9}}, 3);
  expect_the_same_in_both_directions<2>(polyline(corners), points);
  corners.push_back(corners[0]);
  std::vector<Vec<2>> inside;
  for (const Vec<2>& x : points) {
    const Vec<2> far(x[0] + 0.1, 20);
    int crossed = 0;
    for (const Face<2>& face : polyline(corners)) crossed += hides(face, x, far);
    if (crossed % 2 == 1) inside.push_back(x);
  }
  expect_the_same_in_both_directions<2>(polyline(corners), inside);
}

// Regular, with its centre at x.
std::vector<Face<2>> regular_polygon(const Vec<2>& x, double radius, int sides, double turn) {
  std::vector<Vec<2>> corners;
  for (int k = 0; k <= sides; ++k) {
    const double angle = turn + 2 * std::numbers::pi * (k % sides) / sides;
    corners.push_back(x + radius * Vec<2>(std::cos(angle), std::sin(angle)));
  }
  return polyline(corners);
}

// Lines that are almost parallel to faces, and meet many of them: no other test has these.
TEST(Mirrors, AreTheSameInBothDirectionsBetweenRoundBodies) {
  constexpr double radius = 4;
  for (const double gap : {0.7, 1.0, 1.5}) {
    const Vec<2> other = (2 * radius + gap) * Vec<2>(0.8, 0.6);
    auto walls = regular_polygon({0, 0}, radius, 25, 0.1);
    for (const auto& face : regular_polygon(other, radius, 28, 0.3)) walls.push_back(face);
    std::vector<Vec<2>> points;
    const Box<2> around{.lower = other / 2 - Vec<2>(3, 3), .upper = other / 2 + Vec<2>(3, 3)};
    for (const auto& x : random_points(500, around, 4)) {
      const double clear = radius + 0.05;
      if (x.norm() > clear && (x - other).norm() > clear) points.push_back(x);
    }
    expect_the_same_in_both_directions<2>(walls, points);
  }
}

TEST(Mirrors, AreTheSameInBothDirectionsAboveAWavyFloor) {
  std::vector<Vec<2>> floor;
  for (int k = 0; k <= 30; ++k) floor.emplace_back(0.7 * k, 0.8 * std::sin(0.6 * k));
  std::vector<Vec<2>> points;
  for (const auto& x : random_points(600, Box<2>{.lower = {3, -0.5}, .upper = {17, 3}}, 5)) {
    if (x[1] > 0.8 * std::sin(0.6 / 0.7 * x[0]) + 0.1) points.push_back(x);
  }
  expect_the_same_in_both_directions<2>(polyline(floor), points);
}

// Of many triangles, whose backs are not seen: with them, the number of mirrors has no end.
TEST(Mirrors, AreTheSameInBothDirectionsBesideABall) {
  constexpr double radius = 4;
  const auto walls = ball(radius, 12, 12);
  std::vector<Vec<3>> points;
  for (const auto& x : random_points(160, Box<3>{.lower = {2, -2, -2}, .upper = {6, 2, 2}}, 6)) {
    if (x.norm() > radius) points.push_back(x);
  }
  expect_the_same_in_both_directions<3>(walls, points);
}

TEST(Mirrors, MapPointsToTheirImages) {
  const Faces<2> faces("corner", polyline({{0, 9}, {0, 0}, {9, 0}}));
  const Vec<2> x(1, 1.2), point(0.5, 0.8);
  const auto view = view_from<2>(faces, x, {x, point});
  const auto sees = [&](const Vec<2>& image) {
    for (const Vec<2>& at : view.seen) {
      if ((at - image).norm() < 1e-14) return true;
    }
    return false;
  };
  EXPECT_EQ(view.seen.size(), 6);  // x in both walls is beyond the reach
  EXPECT_TRUE(sees(point) && sees({-0.5, 0.8}) && sees({0.5, -0.8}) && sees({-0.5, -0.8}));
  EXPECT_TRUE(sees({-1, 1.2}) && sees({1, -1.2}));
}

TEST(Mirrors, HideWhatIsBehindAThinWall) {
  const Faces<2> faces("wall", polyline({{0, -9}, {0, 0}}));
  MirrorsAround<2> around;
  around.find(faces, {-0.5, -1}, reach);
  EXPECT_EQ(around.visible_share({0.5, -1}), 0);
  EXPECT_EQ(around.visible_share({0.5, 2}), 1);  // beyond its end
  EXPECT_EQ(around.visible_share({0.5, 1}), 0.5);  // through its end
  EXPECT_EQ(around.visible_share({-0.5, 1}), 1);
}

// Those that a lattice has in a line with an edge are no exception.
TEST(Mirrors, HideInSmallStepsBesideAnEdge) {
  const Faces<2> faces("block", polyline({{0, -9}, {0, 0}, {9, 0}}));
  MirrorsAround<2> around;
  around.find(faces, {-0.5, -1}, reach);
  double last = 0;
  for (double y = 0; y < 2; y += 0.001) {
    const double share = around.visible_share({0.5, y});
    EXPECT_LE(std::abs(share - last), 0.125 + 1e-12) << y;
    EXPECT_GE(share, last) << y;
    last = share;
  }
  EXPECT_EQ(last, 1);
}

TEST(Mirrors, KnowProtrudingEdges) {
  const auto protrudes = [](const Faces<2>& faces, const Vec<2>& x) {
    MirrorsAround<2> around;
    around.find(faces, x, reach);
    return around.has_protruding_edge();
  };
  const Faces<2> corner("corner", polyline({{0, 9}, {0, 0}, {9, 0}}));
  EXPECT_FALSE(protrudes(corner, {1, 1}));    // in the corner
  EXPECT_TRUE(protrudes(corner, {-1, 1}));    // behind it
  EXPECT_TRUE(protrudes(corner, {1, -1}));
  EXPECT_FALSE(protrudes(corner, {-1, 5}));   // one face
  const Faces<2> curve("curve", polyline({{-4, 1}, {0, 0}, {4, 1}}));  // by 28°
  EXPECT_FALSE(protrudes(curve, {0, 1}));
  EXPECT_FALSE(protrudes(curve, {0, -1}));
}

// However a side is divided into triangles.
TEST(Mirrors, DoNotDependOnTheTriangulation) {
  std::vector<Face<3>> fine;
  for (const double x : {-4.0, -2.0, 0.0, 2.0}) {
    for (const double y : {-4.0, -2.0, 0.0, 2.0}) {
      const Vec<3> a(x, y, 0), b(x + 2, y, 0), c(x + 2, y + 2, 0), d(x, y + 2, 0);
      fine.push_back({{a, b, c}});
      fine.push_back({{a, c, d}});
    }
  }
  const std::vector<Face<3>> coarse{{{Vec<3>(-20, -20, 0), {20, -20, 0}, {0, 30, 0}}}};
  const std::vector<Vec<3>> points{{0, 0, 1}, {1, 0, 1}, {0, 1, 0.5}, {-1, -1, 0.3}};
  for (const Vec<3>& x : points) {
    EXPECT_EQ(view_from(Faces<3>("fine", fine), x, points).shares,
              view_from(Faces<3>("coarse", coarse), x, points).shares);
  }
}

TEST(Mirrors, SeeBeyondTheEndOfAWallThatIsGivenTwice) {
  for (const auto& points : {std::vector<Vec<2>>{{0, -9}, {0, 0}, {0, -9}},
                             std::vector<Vec<2>>{{0, -9}, {0, -5}, {0, 0}, {0, -5}},
                             std::vector<Vec<2>>{{0, -9}, {0, 0}, {0, -4}}}) {
    const Faces<2> faces("wall", polyline(points));
    MirrorsAround<2> around;
    around.find(faces, {-0.5, -1}, reach);
    EXPECT_EQ(around.visible_share({0.5, 2}), 1);
    EXPECT_EQ(around.visible_share({0.5, -1}), 0);
  }
}

// In any order of its corners, and with −0 for 0.
TEST(Faces, AreKeptOnce) {
  const Faces<2> segment("wall",
                         {{{Vec<2>(0, 1), Vec<2>(2, 0)}}, {{Vec<2>(2, -0.0), Vec<2>(0, 1)}}});
  EXPECT_EQ(segment.elements().size(), 1u);
  const Vec<3> a(0, 0, 0), b(1, 0, 0), c(0, 1, 0), d(1, 1, 0);
  const Faces<3> square("wall", {{{a, b, c}}, {{b, d, c}}, {{c, b, a}}, {{d, c, b}}});
  ASSERT_EQ(square.elements().size(), 2u);
  EXPECT_EQ(square[0].facet, square[1].facet);
}

// What particles in a corner see of each other does not depend on how often the walls are given.
TEST(Mirrors, ShowTheSameInACornerThatIsGivenTwice) {
  const std::vector<Vec<2>> corner{{0, 9}, {0, 0}, {9, 0}};
  std::vector<Face<2>> twice = polyline(corner);
  for (const Face<2>& face : polyline({corner.rbegin(), corner.rend()})) twice.push_back(face);
  const std::vector<Vec<2>> points = lattice<2>({{0, 0}, {4, 4}}, 1.0);
  for (const Vec<2>& x : points) {
    EXPECT_EQ(view_from(Faces<2>("twice", twice), x, points).shares,
              view_from(Faces<2>("once", polyline(corner)), x, points).shares);
  }
}

// Corners rounded to single precision: still one plane, and one mirror.
TEST(Mirrors, ArePlanesInSpiteOfRoundedCorners) {
  const auto rounded = [](double x, double y) -> Vec<3> {
    const Vec<3> at(100 + x, 200 + y, 300 + 0.3 * x - 0.7 * y);
    return at.cast<float>().cast<double>();
  };
  std::vector<Face<3>> triangles;
  for (double x = -8; x < 8; x += 1) {
    for (double y = -8; y < 8; y += 1) {
      triangles.push_back({{rounded(x, y), rounded(x + 1, y), rounded(x + 1, y + 1)}});
      triangles.push_back({{rounded(x, y), rounded(x + 1, y + 1), rounded(x, y + 1)}});
    }
  }
  MirrorsAround<3> around;
  around.find(Faces<3>("plane", triangles), {100.1, 200.2, 301}, reach);
  EXPECT_TRUE(around.is_plane());
}

// Random moves between two faces at any angle, and through the diagonals of the sides of a cube.
TEST(MovesBeforeFaces, EndBeforeThem) {
  const auto expect_before = [](const auto& around, const auto& x, const auto& move) {
    const auto kept = around.before_faces(move, 0.2);
    EXPECT_GT(around.visible_share(x + kept), 0) << x.transpose() << ", " << move.transpose();
    EXPECT_LE(kept.norm(), 2 * move.norm() + 0.4);
  };
  for (const double angle : {0.2, 0.4, 0.8, 1.6, 2.5, 4.0, 5.5}) {
    const Vec<2> end(9 * std::cos(angle), 9 * std::sin(angle));
    const Faces<2> faces("wedge", polyline({{9, 0}, {0, 0}, end}));
    const auto points = random_points(1000, Box<2>{.lower = {-1, -1}, .upper = {1, 1}}, 7);
    const auto moves = random_points(1000, Box<2>{.lower = {-0.5, -0.5}, .upper = {0.5, 0.5}}, 8);
    for (Index k = 0; k < points.size(); ++k) {
      MirrorsAround<2> around;
      around.find(faces, points[k], reach);
      expect_before(around, points[k], moves[k]);
    }
  }
  const Faces<3> cube("cube", faces_of(Box<3>{.lower = {0, 0, 0}, .upper = {2, 2, 2}}));
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {0.0, 2.0}) {
      Vec<3> x(1, 1, 1), move(0, 0, 0);
      x[axis] = side == 0 ? 0.3 : 1.7;
      move[axis] = side - 1;
      MirrorsAround<3> around;
      around.find(cube, x, reach);
      const Vec<3> end = x + around.before_faces(0.5 * move, 0.2);
      EXPECT_NEAR(end[axis], side == 0 ? 0.2 : 1.8, 1e-12);
    }
  }
}

TEST(Faces, AreFoundWithinTheReachOfAnyPoint) {
  const auto corners = random_points(60, Box<3>{.lower = {-5, -5, -5}, .upper = {5, 5, 5}}, 5);
  std::vector<Face<3>> triangles;
  for (Index k = 0; k + 2 < corners.size(); k += 3) {
    triangles.push_back({{corners[k], corners[k + 1], corners[k + 2]}});
  }
  const Faces<3> faces("triangles", triangles);
  for (const auto& x : random_points(300, Box<3>{.lower = {-6, -6, -6}, .upper = {6, 6, 6}}, 6)) {
    std::vector<std::uint32_t> near;
    faces.for_each_near(x, 1.5, [&](std::uint32_t k) { near.push_back(k); });
    for (std::uint32_t k = 0; k < triangles.size(); ++k) {
      if ((nearest_of(triangles[k], x) - x).norm() < 1.5) {
        EXPECT_EQ(std::ranges::count(near, k), 1) << k << " at " << x.transpose();
      }
    }
  }
}

TEST(Faces, OfAnySizeAreFound) {
  for (const double size : {1e-6, 1.0, 1e6, 1e15}) {
    const Faces<2> walls("walls", polyline({{-size, -size}, {size, size}, {size, 2 * size}}));
    std::vector<std::uint32_t> near;
    walls.for_each_near({0, 0}, 1e-7, [&](std::uint32_t k) { near.push_back(k); });
    EXPECT_EQ(std::ranges::count(near, 0u), 1) << size;
  }
}

TEST(Faces, OfOnePlaneAreOneFacetWithoutARimBetweenThem) {
  const Faces<3> cube("cube", faces_of(Box<3>{.lower = {0, 0, 0}, .upper = {2, 2, 2}}));
  ASSERT_EQ(cube.elements().size(), 12);
  for (const auto& element : cube.elements()) {
    EXPECT_EQ(std::ranges::count(cube.elements(), element.facet, [](const auto& other) {
                return other.facet;
              }), 2);
    EXPECT_EQ(std::ranges::count(element.is_rim, true), 2);
  }
  EXPECT_DOUBLE_EQ(cube[0].distance_from_rim({0, 1, 1}), 1);
}

TEST(Faces, ThrowIfOneIsInvalid) {
  const auto nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refuses([&] { Faces<2>("wall", polyline({{0, 0}, {1, 0}, {1, 0}})); },
                      {"wall: face 1 has both ends at", "(1, 0)"}));
  EXPECT_TRUE(refuses([&] { Faces<2>("wall", polyline({{0, 0}, {nan, 0}})); },
                      {"wall: face 0", "nan"}));
  EXPECT_TRUE(refuses([] { Faces<3>("wall", {{{Vec<3>(0, 0, 0), {1, 1, 1}, {2, 2, 2}}}}); },
                      {"wall: face 0", "has no area"}));
  EXPECT_TRUE(refuses([] { Faces<2>("wall", polyline({{0, 0}, {1e200, 0}})); },
                      {"wall: face 0", "(1e+200, 0)", "less than 1e+100 m"}));
}

}  // namespace
}  // namespace silt::test::mirrors_test
