// SPDX-License-Identifier: MIT
// Contacts of a triangle mesh against distances computed directly.
#include <silt/dem/wall/box_wall.hpp>
#include <silt/dem/wall/mesh/mesh_wall.hpp>

#include <Eigen/Geometry>

#include "support/check.hpp"
#include "support/points.hpp"
#include "support/triangles.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace silt::test::mesh_wall_test {
namespace {

using dem::MeshWall;
using Nearest = dem::NearestPoint<3, double>;

// All contacts of a sphere of this radius at x, found by testing all elements.
std::vector<Nearest> pushes_on(const MeshWall<>& wall, const Vec<3>& x, double radius) {
  std::vector<Nearest> pushes;
  for (Index element = 0; element < wall.element_count(); ++element) {
    const auto at = wall.nearest(element, x);
    if (at.distance < radius) pushes.push_back(at);
  }
  return pushes;
}

Triangles moved(Triangles triangles, const Eigen::AngleAxisd& turn, const Vec<3>& shift) {
  for (auto& triangle : triangles) {
    for (auto& x : triangle.corners) x = turn * x + shift;
  }
  return triangles;
}

const Box<3> unit = cube<3, double>(0, 1);
const Box<3> around = cube<3, double>(-0.5, 1.5);

TEST(MeshWall, HasFlatFacetsStraightLinesAndCorners) {
  for (const int n : {1, 2, 5}) {
    auto triangles = box_of_triangles(unit, n);
    std::shuffle(triangles.begin(), triangles.end(), std::mt19937(1));
    const MeshWall wall(moved(triangles, {0.7, Vec<3>(1, 2, 3).normalized()}, {5, -3, 20}));
    EXPECT_EQ(wall.facets(), 6u) << n;
    EXPECT_EQ(wall.lines(), 12u) << n;
    EXPECT_EQ(wall.corners(), 8u) << n;
  }
}

TEST(MeshWall, IsIndependentOfOrientationAndDuplicatesOfTriangles) {
  auto triangles = box_of_triangles(unit, 2);
  for (Index t = 0; t < triangles.size(); t += 3) {
    std::swap(triangles[t].corners[0], triangles[t].corners[2]);
  }
  triangles.push_back(triangles[7]);
  std::rotate(triangles.back().corners.begin(), triangles.back().corners.begin() + 1,
              triangles.back().corners.end());
  const MeshWall wall(triangles);
  EXPECT_EQ(wall.facets(), 6u);
  EXPECT_EQ(wall.lines(), 12u);
}

// The sides of a box have different numbers of quads and meet in the middle of edges.
TEST(MeshWall, HasNoSeamAtTJunctions) {
  Triangles triangles;
  for (int side = 0; side < 6; ++side) {
    const auto all = box_of_triangles(unit, side + 1);
    const Index each = all.size() / 6, first = each * static_cast<Index>(side);
    triangles.insert(triangles.end(), all.begin() + std::ptrdiff_t(first),
                     all.begin() + std::ptrdiff_t(first + each));
  }
  const Eigen::AngleAxisd turn(0.7, Vec<3>(1, 2, 3).normalized());
  for (const auto& mesh : {triangles, moved(triangles, turn, {5, -3, 2})}) {
    const MeshWall wall(mesh);
    EXPECT_EQ(wall.facets(), 6u);
    EXPECT_EQ(wall.lines(), 12u);
    EXPECT_EQ(wall.corners(), 8u);
  }
  Triangles floor;
  add_patch(floor, 2, [](double u, double v) { return Vec<3>(u, v, 0); });
  add_patch(floor, 3, [](double u, double v) { return Vec<3>(1 + u, v, 0); });
  add_patch(floor, 5, [](double u, double v) { return Vec<3>(2 * u, 1 + v, 0); });
  const MeshWall wall(floor);
  EXPECT_EQ(wall.element_count(), 1u + 4u + 4u);
}

// From inside, a box of triangles acts as six planes.
TEST(MeshWall, OfABoxActsAsSixPlanesInside) {
  dem::BoxWall<3> planes{.box = unit};
  planes.check();
  for (const int n : {1, 3}) {
    const MeshWall wall(box_of_triangles(unit, n));
    for (const Vec<3>& x : random_points(1000, unit, 3)) {
      for (const double radius : {0.2, 0.45}) {
        auto pushes = pushes_on(wall, x, radius);
        Index of_planes = 0;
        for (Index side = 0; side < planes.element_count(); ++side) {
          const auto at = planes.nearest(side, x);
          if (!(at.distance < radius)) continue;
          ++of_planes;
          EXPECT_TRUE(std::ranges::any_of(pushes, [&](const Nearest& push) {
            return (push.normal - at.normal).norm() < 1e-15 &&
                   std::abs(push.distance - at.distance) < 1e-15;
          }));
        }
        ASSERT_EQ(pushes.size(), of_planes) << x.transpose();
      }
    }
  }
}

// From outside there is one contact, at the nearest point of the box: on a side, edge or corner.
TEST(MeshWall, OfABoxHasOneContactOutside) {
  dem::BoxWall<3> block{.box = unit, .grains = dem::Side::outside};
  block.check();
  const MeshWall wall(box_of_triangles(unit, 2));
  auto points = random_points(3000, around, 5);
  // Exactly above edges, corners, and lines between triangles.
  for (const double z : {1.0, 1.25}) {
    for (const double x : {0.0, 0.5, 1.0, 1.25}) {
      for (const double y : {0.0, 0.25, 0.5, 1.0}) points.push_back({x, y, z});
    }
  }
  Index seen = 0;
  for (const Vec<3>& x : points) {
    const auto at = block.nearest(0, x);
    if (!(at.distance > 0 && at.distance < 0.3)) continue;
    ++seen;
    const auto pushes = pushes_on(wall, x, 0.3);
    ASSERT_EQ(pushes.size(), 1u) << x.transpose();
    EXPECT_NEAR(pushes[0].distance, at.distance, 1e-15);
    EXPECT_NEAR((pushes[0].normal - at.normal).norm(), 0, 1e-14);
  }
  EXPECT_GT(seen, 500u);
}

TEST(MeshWall, HasContactsAtBothRimsOfAHole) {
  // A frame around a square hole: one facet.
  Triangles frame;
  add_patch(frame, 3, [](double u, double v) { return Vec<3>(3 * u, 3 * v, 0); });
  std::erase_if(frame, [](const auto& t) {
    const Vec<3> middle = (t.corners[0] + t.corners[1] + t.corners[2]) / 3;
    return std::abs(middle[0] - 1.5) < 0.5 && std::abs(middle[1] - 1.5) < 0.5;
  });
  const MeshWall wall(frame);
  EXPECT_EQ(wall.facets(), 1u);
  const auto pushes = pushes_on(wall, {1.5, 1.5, 0.1}, 0.6);
  ASSERT_EQ(pushes.size(), 4u);
  Vec<3> sum = Vec<3>::Zero();
  for (const auto& push : pushes) {
    EXPECT_NEAR(push.distance, std::hypot(0.5, 0.1), 1e-15);
    sum += push.normal;
  }
  EXPECT_NEAR((sum - 4 * 0.1 / std::hypot(0.5, 0.1) * Vec<3>::Unit(2)).norm(), 0, 1e-15);
}

// A rough sheet of triangles.
Triangles sheet(int n, double roughness) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit_range(-1, 1);
  std::vector<double> heights(static_cast<Index>((n + 1) * (n + 1)));
  for (double& height : heights) height = roughness * unit_range(random);
  Triangles all;
  add_patch(all, n, [&](double u, double v) {
    const auto i = static_cast<Index>(std::lround(u * n));
    const auto j = static_cast<Index>(std::lround(v * n));
    return Vec<3>(u, v, heights[i * static_cast<Index>(n + 1) + j]);
  });
  return all;
}

// The nearest contact is the nearest of all triangles; and all near elements are found.
TEST(MeshWall, FindsTheNearestPointOfManyTriangles) {
  for (const double roughness : {0.0, 1e-5, 0.02}) {
    const auto triangles = sheet(15, roughness);
    const MeshWall wall(triangles);
    if (roughness == 0) {
      EXPECT_EQ(wall.element_count(), 1u + 4u + 4u);
    }
    if (roughness > 1e-3) {
      EXPECT_GT(wall.facets(), triangles.size() - 5) << "a few pairs happen to be flat";
    }
    Box<3> air = cube<3, double>(-0.1, 1.1);
    air.lower[2] = -0.1;
    air.upper[2] = 0.1;
    for (const Vec<3>& x : random_points(300, air, 11)) {
      double expected = std::numeric_limits<double>::infinity();
      for (const auto& triangle : triangles) {
        expected = std::min(expected, exact_distance(x, triangle));
      }
      double nearest = std::numeric_limits<double>::infinity();
      for (const auto& push : pushes_on(wall, x, 1)) nearest = std::min(nearest, push.distance);
      // In a facet that is not exactly flat, the height above a face is not exactly the distance.
      ASSERT_NEAR(nearest, expected, roughness == 1e-5 ? 1e-6 : 1e-15) << x.transpose();

      std::vector<char> is_near(wall.element_count(), 0);
      wall.for_each_element_near(x, 0.07, [&](Index element) {
        EXPECT_EQ(is_near[element], 0) << "once";
        is_near[element] = 1;
      });
      for (Index element = 0; element < wall.element_count(); ++element) {
        if (wall.nearest(element, x).distance < 0.07) {
          ASSERT_EQ(is_near[element], 1) << element << " at " << x.transpose();
        }
      }
    }
  }
}

TEST(MeshWall, ThrowsForInvalidTriangles) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refuses([] { MeshWall(Triangles{}); }, {"MeshWall: there are no triangles"}));
  auto triangles = box_of_triangles(unit);
  triangles[3].corners[1] = triangles[3].corners[0];
  EXPECT_TRUE(refuses([&] { MeshWall{triangles}; }, {"MeshWall: triangle 3", "no area"}));
  triangles[3].corners[1][2] = nan;
  EXPECT_TRUE(refuses([&] { MeshWall{triangles}; }, {"MeshWall: triangle 3", "nan"}));
  const Vec<3> far(1e8, 0, 0);
  EXPECT_TRUE(refuses(
      [&] { MeshWall{moved(box_of_triangles(unit), Eigen::AngleAxisd(0, Vec<3>::UnitX()), far)}; },
      {"MeshWall: triangle 0", "too small", "origin"}));
  EXPECT_TRUE(refuses([] { MeshWall(box_of_triangles(unit), {.flat_angle = -1}); },
                      {"MeshSettings: flat_angle"}));
}

TEST(MeshWall, NamesATriangleWithoutAFirstCorner) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Triangle<> triangle{{Vec<3>{nan, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
  EXPECT_TRUE(refuses([&] { MeshWall<>({triangle}); }, {"triangle 0", "nan"}));
}

}  // namespace
}  // namespace silt::test::mesh_wall_test
