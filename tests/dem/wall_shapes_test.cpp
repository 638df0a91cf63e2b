// SPDX-License-Identifier: MIT
// Nearest points of each wall against its geometry.
#include "support/any_wall.hpp"
#include "support/check.hpp"
#include "support/points.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace silt::test::wall_shapes_test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

static_assert(dem::Wall<dem::BoxWall<2>, 2, double> && dem::Wall<dem::BoxWall<3, float>, 3, float>);
static_assert(dem::Wall<dem::Circle<float>, 2, float> && dem::Wall<dem::Cylinder<>, 3, double>);
static_assert(dem::Wall<dem::Polyline<>, 2, double> && dem::Wall<dem::MeshWall<float>, 3, float>);
static_assert(!dem::Wall<dem::Circle<>, 3, double> && !dem::Wall<dem::MeshWall<>, 3, float>);

template <int Dim>
auto pushes_on(const AnyWall<Dim>& wall, const Vec<Dim>& x, double radius) {
  std::vector<dem::NearestPoint<Dim, double>> pushes;
  for (Index element = 0; element < wall.element_count(); ++element) {
    const auto at = wall.nearest(element, x);
    if (at.distance < radius) pushes.push_back(at);
  }
  return pushes;
}

// Near elements are found once, and no element in contact is missed.
template <int Dim>
void expect_near_elements(const AnyWall<Dim>& wall, const Vec<Dim>& x, double radius) {
  std::vector<int> near(wall.element_count(), 0);
  wall.for_each_element_near(x, radius, [&](Index element) { ++near[element]; });
  for (Index element = 0; element < wall.element_count(); ++element) {
    EXPECT_LE(near[element], 1);
    if (wall.nearest(element, x).distance < radius) {
      EXPECT_EQ(near[element], 1) << x.transpose();
    }
  }
}

TEST(BoxWall, ContainsGrainsWithItsSides) {
  const AnyWall<3> wall(dem::BoxWall<3>{
      .box = {.lower = {0, 0, 0}, .upper = {1, 2, inf}, .periodic = {false, true, false}}});
  const auto pushes = pushes_on<3>(wall, {0.1, 0.05, 0.2}, 0.3);
  ASSERT_EQ(pushes.size(), 2u) << "no wall at periodic sides";
  EXPECT_EQ(pushes[0].normal, Vec<3>(1, 0, 0));
  EXPECT_EQ(pushes[0].distance, 0.1);
  EXPECT_EQ(pushes[1].normal, Vec<3>(0, 0, 1));
  EXPECT_EQ(pushes[1].distance, 0.2);
  EXPECT_EQ(pushes_on<3>(wall, {1.1, 1, 5}, 0.3)[0].normal, Vec<3>(-1, 0, 0)) << "solid behind";
  EXPECT_EQ(pushes_on<3>(wall, {0.5, 1, 1e9}, 0.3).size(), 0u) << "it has no lid";
  for (const auto& x : random_points(100, cube<3, double>(-0.2, 1.2), 1)) {
    expect_near_elements<3>(wall, x, 0.3);
  }
}

TEST(BoxWall, IsASolidBlockWithGrainsOutside) {
  const Box<2> box{.lower = {0, 0}, .upper = {2, 1}};
  const AnyWall<2> wall(dem::BoxWall<2>{.box = box, .grains = dem::Side::outside});
  const auto at = [&](const Vec<2>& x) { return wall.nearest(0, x); };
  EXPECT_EQ(at({1, 1.25}).distance, 0.25);
  EXPECT_NEAR(at({2.3, 1.4}).distance, 0.5, 1e-15);
  EXPECT_NEAR((at({2.3, 1.4}).normal - Vec<2>(0.6, 0.8)).norm(), 0, 1e-15);
  EXPECT_EQ(at({1.75, 0.5}).distance, -0.25) << "inside, the normal is that of the nearest side";
  EXPECT_EQ(at({1.75, 0.5}).normal, Vec<2>(1, 0));
  EXPECT_EQ(at({2, 0.5}).normal, Vec<2>(1, 0)) << "on its side";
}

TEST(Circle, ContainsGrainsOrIsASolidDisc) {
  const AnyWall<2> drum(dem::Circle<>{.centre = {1, 2}, .radius = 2});
  const AnyWall<2> disc(dem::Circle<>{.centre = {1, 2}, .radius = 2, .grains = dem::Side::outside});
  for (const auto& x : random_points(100, cube<2, double>(-3, 5), 2)) {
    const Vec<2> out = x - Vec<2>(1, 2);
    EXPECT_NEAR(drum.nearest(0, x).distance, 2 - out.norm(), 1e-15);
    EXPECT_NEAR((drum.nearest(0, x).normal + out.normalized()).norm(), 0, 1e-15);
    EXPECT_NEAR(disc.nearest(0, x).distance, out.norm() - 2, 1e-15);
    EXPECT_NEAR((disc.nearest(0, x).normal - out.normalized()).norm(), 0, 1e-15);
  }
  EXPECT_EQ(drum.nearest(0, {1, 2}).distance, 2);
  EXPECT_EQ(drum.nearest(0, {1, 2}).normal.norm(), 1);
}

// With the axis along z, a cylinder is a circle in (x, y) and a box in (r, z).
TEST(Cylinder, IsABodyOfRevolution) {
  const dem::Cylinder<> pipe{.from = {0, 0, 1}, .to = {0, 0, 3}, .radius = 0.5};
  dem::Cylinder<> drum = pipe;
  drum.ends = true;
  dem::Cylinder<> column = drum;
  column.grains = dem::Side::outside;
  const dem::BoxWall<2> section{.box = {.lower = {-0.5, 1}, .upper = {0.5, 3}},
                                .grains = dem::Side::outside};
  for (const auto& x : random_points(500, Box<3>{.lower = {-1, -1, 0}, .upper = {1, 1, 4}}, 3)) {
    const double r = std::hypot(x[0], x[1]);
    EXPECT_NEAR(pipe.nearest(0, x).distance, 0.5 - r, 1e-15);
    EXPECT_NEAR(drum.nearest(1, x).distance, x[2] - 1, 1e-15);
    EXPECT_NEAR(drum.nearest(2, x).distance, 3 - x[2], 1e-15);
    EXPECT_EQ(drum.nearest(2, x).normal, Vec<3>(0, 0, -1));
    const auto flat = section.nearest(0, {r, x[2]});
    const auto at = column.nearest(0, x);
    const Vec<3> normal(flat.normal[0] * x[0] / r, flat.normal[0] * x[1] / r, flat.normal[1]);
    EXPECT_NEAR(at.distance, flat.distance, 1e-14) << x.transpose();
    EXPECT_NEAR((at.normal - normal).norm(), 0, 1e-13) << x.transpose();
    expect_near_elements<3>(AnyWall<3>(drum), x, 0.3);
  }
  EXPECT_EQ(pipe.element_count(), 1u);
  EXPECT_EQ(drum.element_count(), 3u);
  EXPECT_EQ(column.element_count(), 1u);
}

const std::vector<Vec<2>> zigzag{{0, 0}, {0.5, 0}, {1, 0}, {1, 1}, {2, 0.5}, {3, 0}, {2, 2}};

TEST(Polyline, HasTheNearestPointOfItsSegments) {
  for (const bool closed : {false, true}) {
    const AnyWall<2> wall(dem::Polyline<>{.points = zigzag, .closed = closed});
    EXPECT_EQ(wall.element_count(), closed ? 10u : 9u)
        << "two points are in the middle of straight lines";
    for (const auto& x : random_points(2000, cube<2, double>(-0.5, 3.5), 4)) {
      double expected = inf;
      for (Index k = 0; k + (closed ? 0 : 1) < zigzag.size(); ++k) {
        const dem::Segment<> segment{.from = zigzag[k], .to = zigzag[(k + 1) % zigzag.size()]};
        expected = std::min(expected, segment.nearest(x).distance);
      }
      double nearest = inf;
      for (const auto& push : pushes_on<2>(wall, x, inf)) {
        nearest = std::min(nearest, push.distance);
      }
      ASSERT_NEAR(nearest, expected, 1e-15) << x.transpose();
      expect_near_elements<2>(wall, x, 0.3);
    }
  }
}

TEST(Polyline, HasOneContactOutsideACornerAndTwoInside) {
  const AnyWall<2> wall(dem::Polyline<>{.points = {{-1, 0}, {0, 0}, {0, -1}}});
  EXPECT_EQ(pushes_on<2>(wall, {0.1, 0.1}, 0.2).size(), 1u);
  EXPECT_EQ(pushes_on<2>(wall, {0, 0.1}, 0.2).size(), 1u) << "exactly above the corner";
  EXPECT_EQ(pushes_on<2>(wall, {0.1, 0}, 0.2).size(), 1u);
  EXPECT_EQ(pushes_on<2>(wall, {-0.1, -0.1}, 0.2).size(), 2u);
  EXPECT_EQ(pushes_on<2>(wall, {-0.5, 0.1}, 0.2).size(), 1u);
  EXPECT_EQ(pushes_on<2>(wall, {-1.1, 0.1}, 0.2).size(), 1u) << "its end";
}

TEST(Polyline, KeepsAnEndThatWouldLieOnAStraightLineIfItWereClosed) {
  const std::vector<Vec<2>> points{{0, 0}, {1, 0}, {1, 1}, {-1, 1}, {-1, 0}};
  const AnyWall<2> open(dem::Polyline<>{.points = points});
  EXPECT_EQ(open.element_count(), 9u);
  EXPECT_EQ(pushes_on<2>(open, {0.5, 0.1}, 0.2).size(), 1u);
  const AnyWall<2> closed(dem::Polyline<>{.points = points, .closed = true});
  EXPECT_EQ(closed.element_count(), 8u);
}

TEST(Walls, RejectInvalidParameters) {
  const auto throws = [](auto wall, const std::vector<std::string>& fragments) {
    return refuses([&] { wall.check(); }, fragments);
  };
  EXPECT_TRUE(throws(dem::BoxWall<2>{.box = {.lower = {0, 1}, .upper = {1, 1}}}, {"Box: axis 1"}));
  EXPECT_TRUE(throws(dem::BoxWall<2>{.box = {.lower = {0, 0}, .upper = {1, 1}, .periodic = {true}},
                                     .grains = dem::Side::outside},
                     {"BoxWall", "periodic"}));
  EXPECT_TRUE(throws(dem::Circle<>{}, {"Circle: radius = 0"}));
  EXPECT_TRUE(throws(dem::Circle<>{.centre = {nan, 0}, .radius = 1}, {"Circle: centre = nan"}));
  EXPECT_TRUE(
      throws(dem::Cylinder<>{.to = {0, 0, 0}, .radius = 1}, {"Cylinder: from", "distance 0 m"}));
  EXPECT_TRUE(throws(dem::Cylinder<>{.radius = -1}, {"Cylinder: radius = -1"}));
  EXPECT_TRUE(throws(dem::Polyline<>{.points = {{0, 0}}}, {"Polyline", "number of points = 1"}));
  EXPECT_TRUE(throws(dem::Polyline<>{.points = {{0, 0}, {1, 0}}, .closed = true}, {"at least 3"}));
  EXPECT_TRUE(throws(dem::Polyline<>{.points = {{0, 0}, {1, 0}, {1, 0}}},
                     {"points 1 and 2", "distance 0 m"}));
  EXPECT_TRUE(throws(dem::Polyline<>{.points = {{0, 0}, {1, nan}}}, {"point 1 = nan"}));
}

}  // namespace
}  // namespace silt::test::wall_shapes_test
