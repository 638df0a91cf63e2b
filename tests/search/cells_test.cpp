// SPDX-License-Identifier: MIT
#include <silt/search/cells.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace silt::test::cells_test {
namespace {

// The cells of a square of this length for a search radius of 1/2.
constexpr double radius = 0.5;
Cells<2, double> cells_of_square(double length) {
  Cells<2, double> cells;
  cells.set_up({.lower = {0, 0}, .upper = {length, length}, .middle = {length / 2, length / 2}},
               10000, radius);
  return cells;
}

// How often each bin is in a range of the points closer to x than `distance`.
std::vector<int> visits(const Cells<2, double>& cells, const Vec<2>& x, double distance) {
  std::vector<int> visits(cells.bins(), 0);
  cells.for_each_range_within(x, distance, [&](Index first, Index last) {
    for (Index bin = first; bin < last; ++bin) ++visits[bin];
  });
  return visits;
}

TEST(Cells, WithinADistanceOfManyCellsContainEveryCloserPoint) {
  const auto cells = cells_of_square(20);
  // The worst point is at the end of its cell; distances are a little above and below multiples of
  // the radius, because the edge of a cell is a little above it.
  const double edge = radius * (1 + 0x1p-18);
  const double small = 1.5e-7;
  for (const double number : {1.0, 2.0, 5.0, 12.0}) {
    for (const double excess : {-1e-3, -0x1p-18, 0.0, 0x1p-19, 0x1p-18, 0x1p-18 * 1.5, 0x1p-17}) {
      const double distance = number * radius * (1 + excess);
      for (const double sign : {-1.0, 1.0}) {
        const Vec<2> x = Vec<2>::Constant(20 * edge - sign * small);
        const auto found = visits(cells, x, distance);
        for (const Vec<2>& direction : {Vec<2>(1, 0), Vec<2>(0, 1)}) {
          const Vec<2> other = x + sign * (distance - 1e-9) * direction;
          EXPECT_EQ(found[cells.bin_of(other)], 1) << number << " (1 + " << excess << ") " << sign;
        }
      }
    }
  }
}

TEST(Cells, AreVisitedAtMostOnceForAnyDistance) {
  for (const double length : {1.2, 2.2, 2.7, 3.2}) {
    const auto cells = cells_of_square(length);
    for (double distance = 0.3; distance < 5; distance += 0.25) {
      for (const double x : {0.1, length / 2, length}) {
        const auto found = visits(cells, Vec<2>::Constant(x), distance);
        EXPECT_LE(*std::max_element(found.begin(), found.end()), 1) << length << " " << distance;
      }
    }
  }
}

}  // namespace
}  // namespace silt::test::cells_test
