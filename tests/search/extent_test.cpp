// SPDX-License-Identifier: MIT
#include "support/points.hpp"

#include <silt/core/box.hpp>
#include <silt/core/parallel.hpp>
#include <silt/search/extent.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace silt::test::extent_test {
namespace {

template <int Dim, class Real>
void expect_smallest_box() {
  for (const Real from : {Real(-3), Real(-1), Real(1)}) {
    const auto points = random_points(5000, cube<Dim, Real>(from, from + 2), 3);
    const auto extent = extent_of_points(points);
    Vec<Dim, Real> lower = points[0];
    Vec<Dim, Real> upper = points[0];
    for (const auto& x : points) {
      lower = lower.cwiseMin(x);
      upper = upper.cwiseMax(x);
    }
    EXPECT_EQ(extent.lower, lower);
    EXPECT_EQ(extent.upper, upper);
    EXPECT_TRUE(extent.is_finite());
  }
}

TEST(Extent, IsTheSmallestBoxWithAllPoints) {
  expect_smallest_box<2, double>();
  expect_smallest_box<2, float>();
  expect_smallest_box<3, double>();
  expect_smallest_box<3, float>();
}

template <class Real>
void expect_not_finite_with_one_such_point() {
  using Limits = std::numeric_limits<Real>;
  const Real nan = Limits::quiet_NaN();
  for (const Real broken : {nan, -nan, Limits::infinity(), -Limits::infinity()}) {
    for (const Index i : {Index{0}, Index{1023}, Index{2999}}) {
      for (int k = 0; k < 3; ++k) {
        auto points = random_points(3000, cube<3, Real>(-1, 1), 3);
        points[i][k] = broken;
        EXPECT_FALSE(extent_of_points(points).is_finite());
      }
    }
  }
}

TEST(Extent, IsNotFiniteIfAPointIsNot) {
  expect_not_finite_with_one_such_point<double>();
  expect_not_finite_with_one_such_point<float>();
}

TEST(Extent, IsFiniteForTheLargestNumbersAndForNoPoints) {
  constexpr double largest = std::numeric_limits<double>::max();
  const std::vector<Vec<2>> points{{-largest, 0}, {largest, -0.0}};
  EXPECT_TRUE(extent_of_points(points).is_finite());
  EXPECT_TRUE(extent_of_points(std::vector<Vec<2>>{}).is_finite());
}

}  // namespace
}  // namespace silt::test::extent_test
