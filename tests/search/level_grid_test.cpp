// SPDX-License-Identifier: MIT
#include "support/check.hpp"
#include "support/points.hpp"
#include "support/slow_types.hpp"

#include <silt/core/fields.hpp>
#include <silt/core/lattice.hpp>
#include <silt/search/level_grid.hpp>
#include <silt/search/neighbour_list.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace silt::test::level_grid_test {
namespace {

template <int Dim, class Real = double>
using Grains = Particles<Dim, Real, radius_t>;

template <int Dim, class Real, class SizeOf>
Grains<Dim, Real> grains_in(const Box<Dim, Real>& box, Index n, unsigned seed, SizeOf&& size_of) {
  Grains<Dim, Real> grains(box);
  std::mt19937_64 random(seed);
  for (const auto& x : random_points(n, box, seed)) {
    const Index i = grains.add(x);
    grains[radius][i] = Real(size_of(random));
  }
  return grains;
}

// A few large particles among many small ones.
double bimodal(std::mt19937_64& random) { return random() % 20 == 0 ? 0.2 : 0.02; }
// From 0.02 to 0.2, with more small ones.
double spread(std::mt19937_64& random) {
  return 0.02 * std::pow(10.0, std::pow(std::uniform_real_distribution<double>(0, 1)(random), 3.0));
}
double similar(std::mt19937_64& random) {
  return std::uniform_real_distribution<double>(0.055, 0.06)(random);
}

using Pair = std::pair<Index, Index>;

// Pairs of owners whose surfaces are closer than the gap, by brute force over all images.
template <class P>
std::vector<Pair> brute_force_contacts(const P& grains, double gap) {
  double max_radius = 0;
  for (const auto R : grains[radius]) max_radius = std::max(max_radius, double(R));
  std::vector<Pair> found;
  for (const auto& [i, j, r_ij] :
       brute_force_pairs(grains, typename P::Real(2 * max_radius + gap))) {
    double r2 = 0;
    for (const auto r : r_ij) r2 += double(r) * double(r);
    const double reach = double(grains[radius][i]) + double(grains[radius][j]) + gap;
    if (i < j && r2 < reach * reach) found.emplace_back(i, j);
  }
  std::sort(found.begin(), found.end());
  return found;
}

template <class P, class S>
void expect_right(P& grains, S& search, double gap) {
  search.update(grains);
  const auto expected = brute_force_contacts(grains, gap);
  std::vector<Pair> pairs;
  search.for_each_pair([&](Index i, Index j, const auto&, auto) {
    pairs.emplace_back(std::minmax(i, grains.owner(j)));
  });
  std::sort(pairs.begin(), pairs.end());
  EXPECT_EQ(pairs, expected);

  const auto x = grains.with_ghosts(position);
  const auto R = grains.with_ghosts(radius);
  const auto near = [&](Index i, Index j) { return (x[j] - x[i]).norm() < R[i] + R[j] + gap; };
  std::vector<Pair> candidates;
  std::vector<Pair> neighbours;
  for (Index i = 0; i < grains.size(); ++i) {
    search.for_each_candidate(i, [&](Index j) {
      if (j >= grains.size() && grains.owner(j) < i) return;  // also reported at the other side
      if (near(i, j)) candidates.emplace_back(std::minmax(i, grains.owner(j)));
    });
    search.for_each_neighbour(i, [&](Index j, const auto&, auto) {
      if (i < grains.owner(j)) neighbours.emplace_back(i, grains.owner(j));
    });
  }
  std::sort(candidates.begin(), candidates.end());
  std::sort(neighbours.begin(), neighbours.end());
  EXPECT_EQ(candidates, expected);
  EXPECT_EQ(neighbours, expected);
}

template <int Dim, class Real>
void expect_right_in_space_and_in_periods() {
  for (const bool periodic : {false, true}) {
    auto box = cube<Dim, Real>(0, Dim == 2 ? 4 : 2);
    box.periodic.fill(periodic);
    for (const auto size_of : {bimodal, spread, similar}) {
      for (const double gap : {0.0, 0.01, 0.1}) {
        auto grains = grains_in<Dim, Real>(box, SILT_SLOW_TESTS ? 1200 : 400, 3, size_of);
        const auto R = grains[radius];
        const Real max_radius = *std::max_element(R.begin(), R.end());
        LevelGrid<Dim, Real> search({.radius = 2 * max_radius + Real(gap)});
        expect_right(grains, search, double(search.radius() - 2 * max_radius));
      }
    }
  }
}

TEST(LevelGrid, FindsEveryNearlyTouchingPairForAnySizes) {
  expect_right_in_space_and_in_periods<2, double>();
  expect_right_in_space_and_in_periods<3, double>();
}

TEST(LevelGrid, FindsNothingAmongZeroAndOneParticle) {
  Grains<3> grains;
  LevelGrid<3> search({.radius = 1});
  expect_right(grains, search, 1);
  grains.add({1, 2, 3});
  grains[radius][0] = 0.5;
  expect_right(grains, search, 0);
}

TEST(LevelGrid, FindsPairsIfDistantCellsShareBins) {
  auto grains = grains_in<2, double>(cube<2, double>(0, 3), 400, 5, bimodal);
  for (Index i = 0; i < 100; ++i) grains[position][i] += Vec<2>(1e7 * double(i % 3), -1e8);
  LevelGrid<2> search({.radius = 0.4});
  expect_right(grains, search, 0);
}

TEST(LevelGrid, SortsNeighboursCloseInMemory) {
  for (const bool periodic : {false, true}) {
    auto box = cube<2, double>(0, 4);
    box.periodic.fill(periodic);
    auto grains = grains_in<2, double>(box, 1500, 6, bimodal);
    LevelGrid<2> search({.radius = 0.4});
    const auto distance_in_memory = [&] {
      double sum = 0;
      for (const auto& [i, j] : brute_force_contacts(grains, 0)) sum += double(j - i);
      return sum;
    };
    expect_right(grains, search, 0);
    const double scattered = distance_in_memory();
    search.sort(grains);
    EXPECT_LT(distance_in_memory(), scattered / 5);
    expect_right(grains, search, 0);
    const std::vector<Id> ids(grains.ids().begin(), grains.ids().end());
    search.sort(grains);
    EXPECT_TRUE(std::equal(ids.begin(), ids.end(), grains.ids().begin())) << "they are in order";
    // Added particles are sorted, too.
    for (int k = 0; k < 100; ++k) {
      const Index i = grains.add({0.05 * k, 3});
      grains[radius][i] = 0.02;
    }
    search.sort(grains);
    expect_right(grains, search, 0);
  }
}

TEST(LevelGrid, HasOneLevelForSimilarSizesAndTwoForLargeAmongSmall) {
  const auto levels = [](auto size_of, Index n) {
    auto grains = grains_in<3, double>(cube<3, double>(0, 2), n, 4, size_of);
    const auto R = grains[radius];
    LevelGrid<3> search({.radius = 2 * *std::max_element(R.begin(), R.end())});
    search.update(grains);
    return search.levels();
  };
  EXPECT_EQ(levels(similar, 3000), 1u);
  EXPECT_EQ(levels(bimodal, 3000), 2u);
}

TEST(LevelGrid, WorksInANeighbourList) {
  auto box = cube<2, double>(0, 3);
  box.periodic[0] = true;
  auto grains = grains_in<2, double>(box, 500, 6, bimodal);
  NeighbourList<2, double, LevelGrid<2>> found({.radius = 0.4, .skin_fraction = 0.1});
  for (unsigned step = 0; step < 40; ++step) {
    found.update(grains);
    std::vector<Pair> reported;
    const auto x = grains.with_ghosts(position);
    const auto R = grains.with_ghosts(radius);
    for (Index i = 0; i < grains.size(); ++i) {
      found.for_each_candidate(i, [&](Index j) {
        if (j >= grains.size() && grains.owner(j) < i) return;
        if ((x[j] - x[i]).norm() < R[i] + R[j])
          reported.emplace_back(std::minmax(i, grains.owner(j)));
      });
    }
    std::sort(reported.begin(), reported.end());
    auto wrapped = grains;
    for (auto& at : wrapped[position]) at = box.wrap(at);
    EXPECT_EQ(reported, brute_force_contacts(wrapped, 0)) << step;
    const auto moves = random_points(500, cube<2, double>(-0.004, 0.004), 10 + step);
    for (Index i = 0; i < grains.size(); ++i) grains[position][i] += moves[i];
  }
  EXPECT_GT(found.rebuilds(), 1u);
  EXPECT_LT(found.rebuilds(), 40u);
}

TEST(LevelGrid, InANeighbourListDoesNotCountAsAChangeOfTheRadii) {
  Grains<2> grains;
  for (const auto& x : lattice(cube<2, double>(0, 0.15), 0.0021)) grains.add(x);
  for (auto& R : grains[radius]) R = 0.001;
  const Index large = grains.add({0.07, -0.025});
  grains[radius][large] = 0.025;
  grains.save();
  const auto revision = grains.constants_revision();
  NeighbourList<2> found({.radius = 0.05, .skin_fraction = 0.2});
  found.update(grains);
  EXPECT_LT(found.skin(), 0.001) << "no levels";
  EXPECT_EQ(grains.constants_revision(), revision);
}

// Pebbles around a boulder grow, so that pairs touch that had a large gap.
template <class S>
void expect_contacts_of_grown_particles(S found) {
  Grains<2> grains;
  for (const auto& x : lattice(cube<2, double>(0, 0.09), 0.0015)) grains.add(x);
  const Index pebbles = grains.size();
  const Index boulder = grains.add({0.04, -0.026});
  grains[radius][boulder] = 0.025;
  for (const double R : {0.0007, 0.0007, 0.0025}) {
    for (Index i = 0; i < pebbles; ++i) grains[radius][i] = R;
    found.update(grains);
    const auto touch = [&](Index i, Index j) {
      const double reach = grains[radius][i] + grains[radius][j];
      return (grains[position][j] - grains[position][i]).squaredNorm() < reach * reach;
    };
    Index reported = 0, expected = 0;
    for (Index i = 0; i < grains.size(); ++i) {
      found.for_each_candidate(i, [&](Index j) { reported += touch(i, j); });
      for (Index j = 0; j < i; ++j) expected += touch(i, j);
    }
    EXPECT_EQ(reported, expected) << R;
  }
  EXPECT_EQ(found.rebuilds(), 2u);
}
TEST(LevelGrid, InANeighbourListFindsContactsOfParticlesThatHaveGrown) {
  NeighbourList<2> over_levels({.radius = 0.05, .skin_fraction = 0.2});
  expect_contacts_of_grown_particles(over_levels);
  expect_contacts_of_grown_particles(
      NeighbourList<2, double, LevelGrid<2>>({.radius = 0.05, .skin_fraction = 0.01}));
}

TEST(LevelGrid, IsTheSameForAnyNumberOfThreads) {
  const auto reported_with = [](int number) {
    return with_threads(number, [] {
      auto grains = grains_in<3, double>(cube<3, double>(0, 4), 9000, 7, bimodal);
      LevelGrid<3> search({.radius = 0.4});
      search.update(grains);
      std::vector<Pair> reported;
      for (Index i = 0; i < grains.size(); ++i) {
        search.for_each_candidate(i, [&](Index j) { reported.emplace_back(i, j); });
      }
      return reported;
    });
  };
  const auto one = reported_with(1);
  EXPECT_TRUE(reported_with(2) == one);
  EXPECT_TRUE(reported_with(4) == one);
}

TEST(LevelGrid, RejectsARadiusBelowTheLargestDiameter) {
  auto grains = grains_in<2, double>(cube<2, double>(0, 1), 10, 8, [](auto&) { return 0.1; });
  LevelGrid<2> search({.radius = 0.19});
  EXPECT_TRUE(refuses([&] { search.update(grains); }, {"radius = 0.19", "0.2 m"}));
}

}  // namespace
}  // namespace silt::test::level_grid_test
