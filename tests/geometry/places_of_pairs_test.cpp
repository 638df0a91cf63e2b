// SPDX-License-Identifier: MIT
#include <silt/geometry/places_of_pairs.hpp>

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace silt::test::places_of_pairs_test {
namespace {

// The only test of the table by which contacts are known: it finds what a search of all finds, for pairs on
// a lattice, at the sides of its cells, and nearly at the same place.
TEST(PlacesOfPairs, FindWhatASearchOfAllFinds) {
  constexpr double same = 1e-6;
  std::mt19937 random(1);
  const auto number = [&](int n) { return int(random() % unsigned(n)); };
  PlacesOfPairs<2> places;
  for (int round = 0; round < 2; ++round) {
    places.clear();
    std::vector<std::pair<Vec<2>, Vec<2>>> known;
    Index found = 0;
    for (int k = 0; k < 4000; ++k) {
      Vec<4> at;
      for (double& each : at) {
        each = 0.63e-3 + 1e-3 * number(4) + 0.5e-6 * (number(5) - 2) - 1e-3 * number(2);
      }
      const Vec<2> x = at.head<2>(), y = at.tail<2>();
      const auto is_same = [&](std::uint32_t n) {
        return (known[n].first - x).norm() < same && (known[n].second - y).norm() < same;
      };
      bool expected = false;
      for (std::uint32_t n = 0; n < known.size(); ++n) expected = expected || is_same(n);
      ASSERT_EQ(places.any_near(x, y, same, is_same), expected) << k;
      if (expected) {
        ++found;
        continue;
      }
      places.add(x, y, same);
      known.emplace_back(x, y);
    }
    EXPECT_GT(found, 400u);
    EXPECT_GT(known.size(), 400u);
  }
}

}  // namespace
}  // namespace silt::test::places_of_pairs_test
