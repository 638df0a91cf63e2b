// SPDX-License-Identifier: MIT
#include "support/check.hpp"
#include "support/points.hpp"

#include <silt/search/brute_force.hpp>
#include <silt/search/uniform_grid.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace silt::test {
namespace {

// What the header promises of the number of bins.
constexpr Index most_bins(Index particles) { return 2 * particles + 64; }

template <int Dim, class Real>
void expect_right_and_small(const std::vector<Vec<Dim, Real>>& points, Real radius) {
  auto particles = particles_at(points);
  UniformGrid<Dim, Real> grid({.radius = radius});
  grid.update(particles);
  EXPECT_LE(grid.bins(), most_bins(points.size()));
  EXPECT_EQ(meetings(particles, grid), meetings_by_hand(particles, radius));
}

template <int Dim>
std::vector<Vec<Dim>> clusters(const std::vector<Vec<Dim>>& centres, Index each) {
  std::vector<Vec<Dim>> points;
  unsigned seed = 0;
  for (const auto& centre : centres) {
    for (const auto& x : random_points(each, cube<Dim, double>(-1, 1), ++seed)) {
      points.push_back(centre + x);
    }
  }
  return points;
}

TEST(UniformGrid, TwoParticlesABillionRadiiApartCostAHandfulOfBins) {
  expect_right_and_small<2, double>({{0, 0}, {1e9, 1e9}}, 1.0);
  expect_right_and_small<3, double>({{-1e9, 0, 0}, {1e9, 1e9, -1e9}}, 1.0);
  expect_right_and_small<2, float>({{0, 0}, {1e9f, 1e9f}}, 1.0f);
  expect_right_and_small<3, float>({{0, 0, 0}, {1e9f, 1e9f, 1e9f}}, 1.0f);
}

TEST(UniformGrid, ClustersFarApartAreSearchedWithBinsOfTheOrderOfTheParticles) {
  expect_right_and_small<2, double>(clusters<2>({{0, 0}, {1e6, 3e5}, {-7e7, 1e8}}, 60), 0.4);
  expect_right_and_small<3, double>(
      clusters<3>({{0, 0, 0}, {1e6, 3e5, -2e4}, {-7e6, 1e6, 1e7}}, 60), 0.6);
}

TEST(UniformGrid, FindsPairsOnLongLinesInAnyDirection) {
  for (const Vec<2>& along : {Vec<2>(1, 0), Vec<2>(0, 1), Vec<2>(1, 1), Vec<2>(1, -1), Vec<2>(3, 1)}) {
    std::vector<Vec<2>> points;
    for (int k = 0; k < 500; ++k) points.push_back(0.6 * k * along);
    expect_right_and_small<2, double>(points, 1.0);
  }
  for (const Vec<3>& along : {Vec<3>(1, 0, 0), Vec<3>(0, 0, 1), Vec<3>(1, 1, 1), Vec<3>(1, -1, 2)}) {
    std::vector<Vec<3>> points;
    for (int k = 0; k < 500; ++k) points.push_back(0.4 * k * along);
    expect_right_and_small<3, double>(points, 1.0);
  }
}

// A grid that put the line into a few bins would still find the pairs, but in quadratic time.
template <int Dim>
Index longest_candidate_list(const std::vector<Vec<Dim>>& points) {
  auto particles = particles_at<Dim, double>(points);
  UniformGrid<Dim> grid({.radius = 1.0});
  grid.update(particles);
  // Particles of one bin are consecutive in the grid's order; those of one line that share a bin
  // are far apart in space.
  const auto order = grid.order();
  Index longest = 1;
  Index run = 1;
  for (Index k = 1; k < order.size(); ++k) {
    const bool apart = (points[order[k]] - points[order[k - 1]]).norm() > 10;
    run = apart ? run + 1 : 1;
    longest = std::max(longest, run);
  }
  return longest;
}

TEST(UniformGrid, ADiagonalLineSpreadsOverManyBins) {
  std::vector<Vec<2>> flat;
  std::vector<Vec<3>> deep;
  for (int k = 0; k < 2000; ++k) {
    flat.push_back(Vec<2>::Constant(0.75 * k));
    deep.push_back(Vec<3>::Constant(0.75 * k));
  }
  // Runs of strangers in memory stay short, a small fraction of the line.
  EXPECT_LT(longest_candidate_list<2>(flat), 100u);
  EXPECT_LT(longest_candidate_list<3>(deep), 100u);
}

TEST(UniformGrid, OrderNamesEveryOwnedParticleOnceEvenWithGhosts) {
  auto box = cube<2, double>(0, 4);
  box.periodic.fill(true);
  auto particles = particles_at(random_points(200, box, 3), box);
  UniformGrid<2> grid({.radius = 0.5});
  grid.update(particles);
  ASSERT_GT(particles.total(), particles.size());
  auto order = grid.order();
  std::sort(order.begin(), order.end());
  ASSERT_EQ(order.size(), 200u);
  for (Index i = 0; i < 200; ++i) EXPECT_EQ(order[i], i);
}

TEST(UniformGrid, ReorderingByItsOrderBringsNeighboursCloserInMemory) {
  auto particles = particles_at(random_points(2000, cube<2, double>(0, 10), 4));
  UniformGrid<2> grid({.radius = 0.3});
  const auto distance_in_memory = [&] {
    grid.update(particles);
    double sum = 0;
    grid.for_each_pair([&](Index i, Index j, const Vec<2>&, double) {
      sum += std::abs(double(i) - double(j));
    });
    return sum;
  };
  const double before = distance_in_memory();
  particles.reorder(grid.order());
  EXPECT_LT(distance_in_memory(), before / 5);
}

TEST(UniformGrid, GrainsOfVeryDifferentSizesMeetAsTheLargestReach) {
  // The search sees all pairs within the radius; what touches is a subset, whatever the sizes.
  const auto points = random_points(300, cube<3, double>(0, 3), 11);
  auto particles = particles_at(points);
  std::vector<double> size;
  for (Index i = 0; i < points.size(); ++i) size.push_back(i % 10 == 0 ? 0.5 : 0.01 * double(1 + i % 7));
  const auto touching = [&](auto search) {
    search.update(particles);
    std::vector<std::pair<Index, Index>> found;
    search.for_each_pair([&](Index i, Index j, const Vec<3>&, double r) {
      if (r < size[i] + size[j]) found.emplace_back(i, j);
    });
    std::sort(found.begin(), found.end());
    return found;
  };
  std::vector<std::pair<Index, Index>> by_hand;
  for (Index i = 0; i < points.size(); ++i) {
    for (Index j = i + 1; j < points.size(); ++j) {
      if ((points[j] - points[i]).norm() < size[i] + size[j]) by_hand.emplace_back(i, j);
    }
  }
  EXPECT_GT(by_hand.size(), 100u);
  EXPECT_EQ(touching(UniformGrid<3>({.radius = 1.0})), by_hand);
}

TEST(UniformGrid, PutsTheLastParticleIntoTheLastCellInSinglePrecision) {
  // Extents over the cell edge that are whole numbers in float, but a little less in double.
  for (const float extent : {14.1009541f, 17.7015018f, 8.00030899f, 18.9017124f, 7.20025063f}) {
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<Vec<3, float>> points;
      for (int k = 0; k <= 100; ++k) {
        points.push_back(float(k) / 100 * extent * Vec<3, float>::Unit(axis));
        points.push_back(points.back() + Vec<3, float>::Constant(0.01f));
        points.back()[axis] = std::min(points.back()[axis], extent);
      }
      expect_right_and_small<3, float>(points, 0.1f);
    }
  }
}

TEST(UniformGrid, RefusesAnExtentThatIsNoNumber) {
  auto particles = particles_at<2, double>({{-1.7e308, 0}, {1.7e308, 0}});
  UniformGrid<2> grid({.radius = 1.0});
  EXPECT_TRUE(refuses([&] { grid.update(particles); }, {"extend over inf m", "radii of 1 m"}));
}

}  // namespace
}  // namespace silt::test
