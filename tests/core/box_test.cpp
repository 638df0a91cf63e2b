// SPDX-License-Identifier: MIT
#include "support/check.hpp"
#include "support/points.hpp"

#include <silt/core/box.hpp>
#include <silt/core/lattice.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace silt::test::box_test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

template <class Real>
class Boxes : public ::testing::Test {};
using Reals = ::testing::Types<double, float>;
TYPED_TEST_SUITE(Boxes, Reals);

TYPED_TEST(Boxes, WrapFromAnyNumberOfPeriods) {
  using Real = TypeParam;
  auto box = cube<2, Real>(-1, 3);
  box.periodic[0] = true;
  for (const int periods : {-1000000, -7, -1, 0, 1, 2, 1000000}) {
    const auto x = box.wrap({Real(0.5) + Real(4) * Real(periods), 77});
    EXPECT_NEAR(double(x[0]), 0.5, 1e-1 * (sizeof(Real) == 4) + 1e-9) << periods;
    EXPECT_EQ(x[1], Real(77)) << "the other axis is not periodic";
  }
}

TYPED_TEST(Boxes, WrapIntoTheHalfOpenIntervalInAllCases) {
  using Real = TypeParam;
  const Real maximum = std::numeric_limits<Real>::max();
  for (const Real upper : {Real(1), Real(0.3), Real(1e-3), Real(12345.678)}) {
    auto box = cube<3, Real>(Real(-0.1), upper);
    box.periodic.fill(true);
    for (const Real x : {Real(-0.1), std::nextafter(Real(-0.1), -maximum), upper,
                         std::nextafter(upper, maximum), std::nextafter(upper, -maximum), Real(-1e-30),
                         Real(1e17), Real(-1e17), Real(3e33), maximum / 4, -maximum / 4}) {
      const auto wrapped = box.wrap({x, x, x});
      for (int k = 0; k < 3; ++k) {
        EXPECT_GE(wrapped[k], box.lower[k]) << double(x);
        EXPECT_LT(wrapped[k], box.upper[k]) << double(x);
      }
      EXPECT_EQ(box.wrap(wrapped), wrapped) << "wrapping twice is wrapping once";
    }
  }
}

TYPED_TEST(Boxes, DoNotWrapNonFiniteCoordinates) {
  using Real = TypeParam;
  auto box = cube<2, Real>(0, 1);
  box.periodic.fill(true);
  EXPECT_FALSE(is_finite(box.wrap({Real(nan), 0})[0]));
  EXPECT_FALSE(is_finite(box.wrap({0, Real(-inf)})[1]));
}

TYPED_TEST(Boxes, ContainPointsWithinTheirClosedBounds) {
  using Real = TypeParam;
  auto box = cube<2, Real>(0, 1);
  box.periodic[1] = true;
  EXPECT_TRUE(box.contains({0, 0}));
  EXPECT_TRUE(box.contains({1, 0}));
  EXPECT_TRUE(box.contains({1, 99}));
  EXPECT_FALSE(box.contains({std::nextafter(Real(1), Real(2)), 0}));
  EXPECT_FALSE(box.contains({Real(-1e-30), 0}));
  EXPECT_FALSE(box.contains({Real(nan), 0}));
  EXPECT_TRUE((Box<2, Real>{}).contains({Real(1e30), Real(-1e30)})) << "unbounded by default";
}

TEST(Box, HasNoClearanceFromPeriodicSides) {
  Box<2> box{.lower = {0, 0}, .upper = {1, 2}};
  EXPECT_EQ(box.clearance({0.125, 0.5}), 0.125);
  box.periodic[0] = true;
  EXPECT_EQ(box.clearance({0.125, 0.5}), 0.5);
  box.periodic[1] = true;
  EXPECT_EQ(box.clearance({0.125, 0.5}), inf);
}

TEST(Box, RejectsBoundsWithoutVolume) {
  EXPECT_TRUE(refuses([] { cube<2, double>(1, 1).check(); }, {"axis 0", "lower = 1", "upper = 1"}));
  auto box = cube<3, double>(0, 1);
  box.upper[2] = -2;
  EXPECT_TRUE(refuses([&] { box.check(); }, {"axis 2", "lower = 0", "upper = -2"}));
  box.upper[2] = nan;
  EXPECT_TRUE(refuses([&] { box.check(); }, {"axis 2", "nan"}));
  box.upper[2] = inf;
  EXPECT_NO_THROW(box.check());
  box.periodic[2] = true;
  EXPECT_TRUE(refuses([&] { box.check(); }, {"axis 2: upper = inf"}));
  Particles<3, double> particles;
  EXPECT_TRUE(refuses([&] { particles.set_box(box); }, {"axis 2: upper = inf"}));
  EXPECT_TRUE(refuses([&] { (Particles<3, double>(box)); }, {"axis 2: upper = inf"}));
}

TYPED_TEST(Boxes, AreFilledByALatticeWithTheRightNumberOfPoints) {
  using Real = TypeParam;
  for (int n = 1; n < 300; n += 7) {
    for (const double spacing : {0.1, 0.3, 0.04, 0.007}) {
      Box<2, Real> box;
      box.lower = {Real(-0.37), 0};
      box.upper = {Real(-0.37 + n * spacing), Real(2 * spacing)};
      const auto points = lattice(box, Real(spacing));
      ASSERT_EQ(points.size(), 2u * static_cast<Index>(n)) << spacing;
      for (const auto& x : points) ASSERT_TRUE(box.contains(x));
      EXPECT_NEAR(double((points[1] - points[0])[n == 1 ? 1 : 0]), spacing, 1e-6);
    }
  }
}

TEST(Lattice, LeavesOutCellsThatDoNotFit) {
  EXPECT_EQ(lattice<3>({{0, 0, 0}, {0.99, 1, 1.01}}, 0.25).size(), 3u * 4u * 4u);
  EXPECT_TRUE(refuses(
      [] { lattice<2>({{0, 0}, {1, 0.2}}, 0.25); },
      {"lattice: spacing = 0.25 m is longer than the box along axis 1", "(1, 0.2) m"}));
}

TEST(Lattice, RejectsInvalidSpacingsAndBoxes) {
  EXPECT_TRUE(refuses([] { lattice<2>({{0, 0}, {1, 1}}, 0.0); }, {"spacing = 0"}));
  EXPECT_TRUE(refuses([] { lattice<2>({{0, 0}, {1, 1}}, -1.0); }, {"spacing = -1"}));
  EXPECT_TRUE(refuses([] { lattice<2>({{0, 0}, {1, 1}}, nan); }, {"spacing = nan"}));
  EXPECT_TRUE(refuses([] { lattice<2>({{0, 0}, {1, inf}}, 0.1); }, {"upper = inf"}));
  EXPECT_TRUE(refuses([] { lattice<2>({{0, nan}, {1, 1}}, 0.1); }, {"lower = nan"}));
  EXPECT_TRUE(refuses([] { lattice<2>({{0, 1}, {1, 0}}, 0.1); }, {"axis 1", "lower = 1"}));
  EXPECT_TRUE(refuses([] { lattice<2>({{0, 0}, {1, 1}}, 1e-9); }, {"spacing = 1e-09"}));
  EXPECT_TRUE(refuses([] { lattice<3>({{0, 0, 0}, {1, 1, 1}}, 1e-8); }, {"spacing = 1e-08"}));
}

TEST(Lattice, RejectsMoreThan1e8PointsAlongAllAxes) {
  EXPECT_TRUE(refuses([] { lattice<2, float>({{0, 0}, {1, 1.2f}}, 1e-4f); },
                      {"spacing = 0.0001 m gives more than 1e8 points"}));
}

}  // namespace
}  // namespace silt::test::box_test
