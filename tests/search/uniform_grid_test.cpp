// SPDX-License-Identifier: MIT
#include "support/check.hpp"
#include "support/points.hpp"

#include <silt/search/brute_force.hpp>
#include <silt/search/uniform_grid.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace silt::test::uniform_grid_test {
namespace {

// Maximum number of bins, see search/cells.hpp.
constexpr Index max_bins(Index particles) { return 16 * particles + 64; }

template <int Dim, class Real>
void expect_right_and_small(const std::vector<Vec<Dim, Real>>& points, Real radius) {
  auto particles = particles_at(points);
  UniformGrid<Dim, Real> grid({.radius = radius});
  grid.update(particles);
  EXPECT_LE(grid.bins(), max_bins(points.size()));
  EXPECT_EQ(neighbour_pairs(particles, grid), brute_force_pairs(particles, radius));
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

TEST(UniformGrid, TwoParticlesABillionRadiiApartNeedFewBins) {
  expect_right_and_small<2, double>({{0, 0}, {1e9, 1e9}}, 1.0);
  expect_right_and_small<3, double>({{-1e9, 0, 0}, {1e9, 1e9, -1e9}}, 1.0);
  expect_right_and_small<2, float>({{0, 0}, {1e9f, 1e9f}}, 1.0f);
  expect_right_and_small<3, float>({{0, 0, 0}, {1e9f, 1e9f, 1e9f}}, 1.0f);
}

TEST(UniformGrid, TheNumberOfBinsForDistantClustersIsProportionalToThatOfParticles) {
  expect_right_and_small<2, double>(clusters<2>({{0, 0}, {1e6, 3e5}, {-7e7, 1e8}}, 60), 0.4);
  expect_right_and_small<3, double>(
      clusters<3>({{0, 0, 0}, {1e6, 3e5, -2e4}, {-7e6, 1e6, 1e7}}, 60), 0.6);
}

TEST(UniformGrid, FindsPairsOnLongLinesInAnyDirection) {
  for (const Vec<2>& along :
       {Vec<2>(1, 0), Vec<2>(0, 1), Vec<2>(1, 1), Vec<2>(1, -1), Vec<2>(3, 1)}) {
    std::vector<Vec<2>> points;
    for (int k = 0; k < 500; ++k) points.push_back(0.6 * k * along);
    expect_right_and_small<2, double>(points, 1.0);
  }
  for (const Vec<3>& along :
       {Vec<3>(1, 0, 0), Vec<3>(0, 0, 1), Vec<3>(1, 1, 1), Vec<3>(1, -1, 2)}) {
    std::vector<Vec<3>> points;
    for (int k = 0; k < 500; ++k) points.push_back(0.4 * k * along);
    expect_right_and_small<3, double>(points, 1.0);
  }
}

// With the line in a few bins, the pairs would still be found, but in quadratic time.
template <int Dim>
Index longest_candidate_list(const std::vector<Vec<Dim>>& points) {
  auto particles = particles_at<Dim, double>(points);
  UniformGrid<Dim> grid({.radius = 1.0});
  grid.update(particles);
  // Particles of one bin are consecutive in the order of the grid; those of one line in the same
  // bin are far apart in space.
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
  // Few distant particles share a bin.
  EXPECT_LT(longest_candidate_list<2>(flat), 100u);
  EXPECT_LT(longest_candidate_list<3>(deep), 100u);
}

TEST(UniformGrid, OrderContainsEveryOwnedParticleOnceEvenWithGhosts) {
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

TEST(UniformGrid, FindsContactsOfVeryDifferentSizes) {
  // The search finds all pairs within the radius; contacts are a subset for any sizes.
  const auto points = random_points(300, cube<3, double>(0, 3), 11);
  auto particles = particles_at(points);
  std::vector<double> size;
  for (Index i = 0; i < points.size(); ++i)
    size.push_back(i % 10 == 0 ? 0.5 : 0.01 * double(1 + i % 7));
  const auto touching = [&](auto search) {
    search.update(particles);
    std::vector<std::pair<Index, Index>> found;
    search.for_each_pair([&](Index i, Index j, const Vec<3>&, double r) {
      if (r < size[i] + size[j]) found.emplace_back(i, j);
    });
    std::sort(found.begin(), found.end());
    return found;
  };
  std::vector<std::pair<Index, Index>> expected;
  for (Index i = 0; i < points.size(); ++i) {
    for (Index j = i + 1; j < points.size(); ++j) {
      if ((points[j] - points[i]).norm() < size[i] + size[j]) expected.emplace_back(i, j);
    }
  }
  EXPECT_GT(expected.size(), 100u);
  EXPECT_EQ(touching(UniformGrid<3>({.radius = 1.0})), expected);
}

TEST(UniformGrid, PutsTheLastParticleIntoTheLastCellInSinglePrecision) {
  // Extents whose ratio to the cell edge is an integer in float, but slightly less in double.
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

TEST(UniformGrid, FindsPairsWhoseExtentOverflows) {
  expect_right_and_small<2, double>({{-1.7e308, 0}, {1.7e308, 0}, {1.7e308, 0.5}}, 1.0);
  expect_right_and_small<3, float>({{-3e38f, 0, 0}, {3e38f, 0, 0}, {3e38f, 0, 0.5f}}, 1.0f);
}

TEST(UniformGrid, FindsPairsWhereNumbersAreFartherApartThanCells) {
  expect_right_and_small<2, double>({{1e25, 0}, {1e25, 0.5}, {1e25, 3}}, 1.0);
  expect_right_and_small<3, double>({{0, 1e40, 0}, {0.5, 1e40, 0}, {3, 1e40, 0}}, 1.0);
  expect_right_and_small<3, float>({{0, 0, -1e30f}, {0, 0.5f, -1e30f}}, 1.0f);
}

// Compares the rows with brute force: no pair is missing, and none is farther than the radius by
// more than rounding.
template <int Dim, class Real>
void expect_right_rows(const Particles<Dim, Real>& start, Real radius) {
  auto particles = start;
  UniformGrid<Dim, Real> grid({.radius = radius});
  grid.update(particles);
  NeighbourRows full;
  NeighbourRows half;
  grid.build_rows(full, Pairs::twice);
  grid.build_rows(half, Pairs::once);
  const auto x = particles.with_ghosts(position);
  const auto near = [&](Index i, Index j) {
    const Real r = (x[j] - x[i]).norm();
    EXPECT_LE(r, radius * Real(1.0001));
    return (x[j] - x[i]).squaredNorm() < radius * radius;
  };
  std::vector<NeighbourPair<Dim, Real>> twice;
  std::vector<NeighbourPair<Dim, Real>> once;
  for (Index i = 0; i < particles.size(); ++i) {
    for (const Index j : full[grid.slot_of(i)]) {
      if (near(i, j))
        twice.push_back(neighbour_pair<Dim, Real>(i, particles.owner(j), x[j] - x[i]));
    }
    std::vector<Index> row;
    for (const Index j : half[grid.slot_of(i)]) {
      row.push_back(j);
      if (!near(i, j)) continue;
      const Index owner = particles.owner(j);
      if (j >= particles.size() && owner < i) continue;
      once.push_back(i < owner ? neighbour_pair<Dim, Real>(i, owner, x[j] - x[i])
                               : neighbour_pair<Dim, Real>(owner, i, x[i] - x[j]));
    }
    // Only one of the two may contain a candidate that is farther than the radius by rounding.
    std::vector<Index> candidates;
    grid.for_each_candidate(i, [&](Index j) { candidates.push_back(j); });
    std::erase_if(row, [&](Index j) { return !near(i, j); });
    std::erase_if(candidates, [&](Index j) { return !near(i, j); });
    EXPECT_EQ(row, candidates);
  }
  std::sort(twice.begin(), twice.end());
  std::sort(once.begin(), once.end());
  // The vectors of a pair and of its image differ by rounding.
  const auto expected = brute_force_pairs(particles, radius);
  EXPECT_EQ(twice, expected);
  if (particles.total() == particles.size()) {
    EXPECT_EQ(once, once_each(expected));
  } else {
    EXPECT_EQ(once.size(), once_each(expected).size());
  }
}

template <int Dim, class Real>
void expect_right_rows_everywhere() {
  for (const bool periodic : {false, true}) {
    auto box = cube<Dim, Real>(0, 2);
    box.periodic.fill(periodic);
    for (const Index n : {Index{0}, Index{1}, Index{40}, Index{600}}) {
      for (const Real radius : {Real(0.08), Real(0.3), Real(0.9)}) {
        expect_right_rows(particles_at(random_points(n, box, unsigned(n)), box), radius);
      }
    }
  }
  // A line, many particles at one point, all in one cell, and two that are very far away.
  std::vector<Vec<Dim, Real>> line;
  for (int k = 0; k < 300; ++k) line.push_back(Real(0.3) * Real(k) * Vec<Dim, Real>::Unit(k % Dim));
  expect_right_rows(particles_at(line), Real(1));
  expect_right_rows(particles_at(std::vector(200, Vec<Dim, Real>(Vec<Dim, Real>::Ones()))),
                    Real(1));
  expect_right_rows(particles_at(random_points(300, cube<Dim, Real>(0, 1), 3)), Real(9));
  auto apart = random_points(300, cube<Dim, Real>(0, 3), 4);
  apart.push_back(Vec<Dim, Real>::Constant(Real(1e9)));
  apart.push_back(Vec<Dim, Real>::Constant(Real(-1e9)));
  expect_right_rows(particles_at(apart), Real(1));
}

TEST(UniformGrid, BuildsRowsOfAllPairsAndOfEachPairOnce) {
  expect_right_rows_everywhere<2, double>();
  expect_right_rows_everywhere<2, float>();
  expect_right_rows_everywhere<3, double>();
  expect_right_rows_everywhere<3, float>();
}

TEST(UniformGrid, ReportsEachPairAcrossAPeriodicSideOnce) {
  auto box = cube<2, double>(0, 2);
  box.periodic.fill(true);
  auto particles = particles_at(random_points(200, box, 5), box);
  UniformGrid<2> grid({.radius = 0.3});
  grid.update(particles);
  std::vector<std::pair<Index, Index>> found;
  for (Index i = 0; i < particles.size(); ++i) {
    grid.for_each_candidate(i, [&](Index j) {
      if (grid.is_second_image(i, j)) return;
      if ((particles.with_ghosts(position)[j] - particles[position][i]).norm() < 0.3 - 1e-9) {
        found.emplace_back(std::minmax(i, particles.owner(j)));
      }
    });
  }
  std::sort(found.begin(), found.end());
  EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
  EXPECT_EQ(found.size(), brute_force_pairs(particles, 0.3 - 1e-9).size() / 2);
}

TEST(UniformGrid, IsTheSameForAnyNumberOfThreads) {
  auto box = cube<3, double>(0, 2);
  box.periodic[0] = true;
  const auto rows_with = [&](int number, Pairs pairs) {
    return with_threads(number, [&] {
      auto particles = particles_at(random_points(9000, box, 6), box);
      UniformGrid<3> grid({.radius = 0.15});
      grid.update(particles);
      NeighbourRows rows;
      grid.build_rows(rows, pairs);
      std::vector<std::uint32_t> all;
      for (Index row = 0; row < rows.size(); ++row) {
        all.push_back(static_cast<std::uint32_t>(rows[row].size()));
        all.insert(all.end(), rows[row].begin(), rows[row].end());
      }
      return all;
    });
  };
  for (const Pairs pairs : {Pairs::twice, Pairs::once}) {
    const auto one = rows_with(1, pairs);
    EXPECT_EQ(rows_with(2, pairs), one);
    EXPECT_EQ(rows_with(4, pairs), one);
    EXPECT_EQ(rows_with(7, pairs), one);
  }
}

TEST(UniformGrid, SortsManyParticlesThatAreNotInCellOrder) {
  auto particles = particles_at(random_points(3000, cube<2, double>(0, 10), 4));
  UniformGrid<2> grid({.radius = 0.3});
  grid.sort(particles);
  const auto revision = particles.revision();
  EXPECT_NE(particles.id(0), 0u);
  grid.update(particles);
  for (Index i = 0; i < particles.size(); ++i) ASSERT_EQ(grid.slot_of(i), i);
  grid.sort(particles);
  EXPECT_EQ(particles.revision(), revision);  // in order already

  auto few = particles_at(random_points(300, cube<2, double>(0, 10), 4));
  grid.sort(few);
  for (Index i = 0; i < few.size(); ++i) EXPECT_EQ(few.id(i), i);
}

TEST(UniformGrid, LeavesTheOrderIfAPositionIsNotFinite) {
  for (const double broken : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    auto particles = particles_at(random_points(3000, cube<2, double>(0, 10), 4));
    particles[position][1700].y() = broken;
    UniformGrid<2> grid({.radius = 0.3});
    grid.sort(particles);
    for (Index i = 0; i < particles.size(); ++i) ASSERT_EQ(particles.id(i), i);
    EXPECT_THROW(grid.update(particles), Error);
  }
}

}  // namespace
}  // namespace silt::test::uniform_grid_test
