// SPDX-License-Identifier: MIT
#include "support/check.hpp"
#include "support/points.hpp"

#include <silt/search/neighbour_list.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

namespace silt::test::neighbour_list_test {
namespace {

// Three particles in a line, and a list with a radius of 1 m and a skin of 20 %.
Particles<2, double> three() { return particles_at<2, double>({{0, 0}, {0.9, 0}, {2.15, 0}}); }
NeighbourList<2> list() { return NeighbourList<2>({.radius = 1, .skin_fraction = 0.2}); }

TEST(NeighbourList, IsBuiltOnceWhileParticlesAreAtRest) {
  auto particles = three();
  auto found = list();
  for (int k = 0; k < 10; ++k) found.update(particles);
  EXPECT_EQ(found.rebuilds(), 1u);
}

TEST(NeighbourList, IsReusedUntilAParticleHasMovedByHalfTheSkin) {
  auto particles = three();
  auto found = list();
  found.update(particles);
  particles[position][2][1] += 0.0999;
  found.update(particles);
  EXPECT_EQ(found.rebuilds(), 1u);
  particles[position][2][1] += 0.0002;
  found.update(particles);
  EXPECT_EQ(found.rebuilds(), 2u);
}

TEST(NeighbourList, FindsNewPairsWithinTheRadiusWithoutARebuild) {
  auto particles = particles_at<2, double>({{0, 0}, {1.15, 0}});
  auto found = list();
  found.update(particles);
  EXPECT_EQ(pairs(particles, found).size(), 0u);
  particles[position][0][0] += 0.09;
  particles[position][1][0] -= 0.09;
  found.update(particles);
  EXPECT_EQ(found.rebuilds(), 1u);
  EXPECT_EQ(pairs(particles, found).size(), 1u);
}

TEST(NeighbourList, IsRebuiltWhenParticlesAreAddedRemovedOrReordered) {
  auto particles = three();
  auto found = list();
  found.update(particles);
  particles.add({5, 5});
  found.update(particles);
  EXPECT_EQ(found.rebuilds(), 2u);
  particles.remove(1);
  found.update(particles);
  EXPECT_EQ(found.rebuilds(), 3u);
  const std::vector<Index> order{2, 0, 1};
  particles.reorder(order);
  found.update(particles);
  EXPECT_EQ(found.rebuilds(), 4u);
  found.set_radius(1.5);
  found.update(particles);
  EXPECT_EQ(found.rebuilds(), 5u);
  found.set_radius(1.5);
  found.update(particles);
  EXPECT_EQ(found.rebuilds(), 5u);
}

TEST(NeighbourList, WithoutSkinIsRebuiltAtEveryDisplacement) {
  auto particles = three();
  NeighbourList<2> found({.radius = 1, .skin_fraction = 0});
  found.update(particles);
  particles[position][0][0] += 1e-9;
  found.update(particles);
  EXPECT_EQ(found.rebuilds(), 2u);
}

TEST(NeighbourList, WorksForDifferentSetsOfParticlesInTurn) {
  auto near = particles_at<2, double>({{0, 0}, {0.5, 0}, {10, 0}});
  auto apart = particles_at<2, double>({{0, 0}, {5, 0}, {5.5, 0}});
  auto found = list();
  found.update(near);
  found.update(apart);
  EXPECT_EQ(neighbour_pairs(apart, found), brute_force_pairs(apart, 1.0));
}

// Every pair closer than radius() + margin() is among the candidates once (once at each side across
// a periodic side).
template <class P, class S>
void expect_all_candidates(const P& particles, const S& found) {
  const auto x = particles.with_ghosts(position);
  const double reach = found.radius() + found.margin();
  std::vector<std::pair<Index, Index>> reported;
  for (Index i = 0; i < particles.size(); ++i) {
    found.for_each_candidate(i, [&](Index j) {
      if (j >= particles.size() && particles.owner(j) < i) return;
      if ((x[j] - x[i]).norm() < reach - 1e-9)
        reported.emplace_back(std::minmax(i, particles.owner(j)));
    });
  }
  std::sort(reported.begin(), reported.end());
  EXPECT_EQ(std::adjacent_find(reported.begin(), reported.end()), reported.end());
  EXPECT_EQ(reported.size(), brute_force_pairs(particles, reach - 1e-9).size() / 2);
}

template <class P>
void shake(P& particles, double by, unsigned seed) {
  const auto moves = random_points(particles.size(), cube<P::dimension, double>(-by, by), seed);
  for (Index i = 0; i < particles.size(); ++i) particles[position][i] += moves[i];
}

TEST(NeighbourList, ReportsEveryPairWithinItsMarginOnceWhileParticlesMove) {
  for (const bool periodic : {false, true}) {
    auto box = cube<3, double>(0, 2);
    box.periodic.fill(periodic);
    auto particles = particles_at(random_points(400, box, 1), box);
    NeighbourList<3> found({.radius = 0.3, .skin_fraction = 0.3});
    double min_margin = found.radius();
    for (unsigned step = 0; step < 60; ++step) {
      found.update(particles);
      expect_all_candidates(particles, found);
      min_margin = std::min(min_margin, found.margin());
      shake(particles, 0.004, 10 + step);
    }
    EXPECT_GT(found.rebuilds(), 1u);
    EXPECT_LT(min_margin, 0.05);
  }
}

TEST(NeighbourList, ReducesItsMarginByTwiceTheMaximumDisplacement) {
  auto particles = three();
  auto found = list();
  found.update(particles);
  EXPECT_DOUBLE_EQ(found.margin(), 0.2);
  particles[position][2][1] += 0.03;
  particles[position][1][1] -= 0.02;
  found.update(particles);
  EXPECT_NEAR(found.margin(), 0.14, 1e-15);
}

TEST(NeighbourList, GivesTheSamePairsBeforeAndAfterItsRowsAreBuilt) {
  const auto box = cube<2, double>(0, 2);
  auto particles = particles_at(random_points(150, box, 2), box);
  NeighbourList<2> found({.radius = 0.3, .skin_fraction = 0.2});
  found.update(particles);
  const auto first = neighbour_pairs(particles, found);
  const auto first_pairs = pairs(particles, found);
  found.update(particles);
  EXPECT_EQ(found.rebuilds(), 1u);
  EXPECT_EQ(neighbour_pairs(particles, found), first);
  EXPECT_EQ(pairs(particles, found), first_pairs);
  EXPECT_EQ(first, brute_force_pairs(particles, 0.3));
  EXPECT_EQ(first_pairs, once_each(first));
}

TEST(NeighbourList, SortsParticlesOnlyBeforeARebuild) {
  const auto box = cube<2, double>(0, 10);
  auto particles = particles_at(random_points(3000, box, 3), box);
  NeighbourList<2> found({.radius = 0.3, .skin_fraction = 0.2});
  found.sort(particles);
  EXPECT_NE(particles.id(0), 0u);
  found.update(particles);
  const auto revision = particles.revision();
  for (int step = 0; step < 5; ++step) {
    found.sort(particles);
    found.update(particles);
  }
  EXPECT_EQ(found.rebuilds(), 1u);
  EXPECT_EQ(particles.revision(), revision);
  // Sheared until the rows of cells have been reordered.
  for (int step = 0; step < 300; ++step) {
    for (auto& x : particles[position]) x[0] += 0.005 * x[1];
    found.sort(particles);
    found.update(particles);
  }
  EXPECT_GT(found.rebuilds(), 3u);
  EXPECT_NE(particles.revision(), revision);
  EXPECT_EQ(pairs(particles, found).size(), brute_force_pairs(particles, 0.3).size() / 2);
}

// Displacements of constant size in constant directions; returns the number of rebuilds and the
// final skin.
struct Rebuilds {
  std::uint64_t number;
  double skin;
};
template <class S>
Rebuilds fly(S found, double by, int steps) {
  const auto box = cube<3, double>(0, 2);
  auto particles = particles_at(random_points(400, box, 4), box);
  const auto moves = random_points(400, cube<3, double>(-by, by), 5);
  for (int step = 0; step < steps; ++step) {
    found.update(particles);
    for (Index i = 0; i < particles.size(); ++i) {
      found.for_each_candidate(i, [](Index) {});
      particles[position][i] += step % 400 < 200 ? moves[i] : -moves[i];
    }
  }
  return {found.rebuilds(), found.skin()};
}

TEST(NeighbourList, IncreasesItsSkinWithTheSpeedOfTheParticles) {
  const auto slow = fly(NeighbourList<3>({.radius = 0.3}), 3e-4, 1000);
  const auto fast = fly(NeighbourList<3>({.radius = 0.3}), 3e-3, 1000);
  EXPECT_GT(fast.skin, 1.2 * slow.skin);
  EXPECT_GT(fast.number, slow.number);
  const auto again = fly(NeighbourList<3>({.radius = 0.3}), 3e-3, 1000);
  EXPECT_EQ(again.skin, fast.skin);
  EXPECT_EQ(again.number, fast.number);
}

TEST(NeighbourList, KeepsAGivenSkin) {
  EXPECT_DOUBLE_EQ(fly(NeighbourList<3>({.radius = 0.3, .skin_fraction = 0.1}), 3e-3, 200).skin,
                   0.03);
}

TEST(NeighbourList, IsRestoredWhenAStepIsRolledBack) {
  const auto box = cube<3, double>(0, 2);
  const auto run = [&](bool fails) {
    auto particles = particles_at(random_points(400, box, 6), box);
    NeighbourList<3> found({.radius = 0.3});
    std::vector<std::tuple<Index, Index, double>> reported;
    for (unsigned step = 0; step < 60; ++step) {
      if (fails && step % 7 == 3) {
        const auto pairs_of = [](const NeighbourList<3>& list) {
          std::vector<std::tuple<Index, Index, double>> pairs;
          list.for_each_pair(
              [&](Index i, Index j, const Vec<3>&, double r) { pairs.emplace_back(i, j, r); });
          return pairs;
        };
        const auto known = pairs_of(found);
        found.save();
        const std::vector<Vec<3>> before(particles[position].begin(), particles[position].end());
        shake(particles, 0.05, 90);
        found.update(particles);
        std::copy(before.begin(), before.end(), particles[position].begin());
        if (step % 2 == 0) {
          found.restore();
        } else {
          found.restore(particles);
          EXPECT_TRUE(pairs_of(found) == known) << "the list is built at once";
        }
      }
      found.save();
      found.update(particles);
      for (Index i = 0; i < particles.size(); ++i) {
        found.for_each_candidate(i, [&](Index j) { reported.emplace_back(i, j, found.margin()); });
      }
      shake(particles, 0.004, 10 + step);
    }
    return reported;
  };
  EXPECT_TRUE(run(true) == run(false));
}

TEST(NeighbourList, IsTheSameForAnyNumberOfThreads) {
  const auto run = [](int number) {
    return with_threads(number, [] {
      const auto box = cube<3, double>(0, 2);
      auto particles = particles_at(random_points(5000, box, 7), box);
      NeighbourList<3> found({.radius = 0.15});
      std::vector<Id> reported;
      for (unsigned step = 0; step < 30; ++step) {
        found.sort(particles);
        found.update(particles);
        for (Index i = 0; i < particles.size(); ++i) {
          found.for_each_candidate(i, [&](Index j) { reported.push_back(particles.id(j)); });
          found.for_each_neighbour(i,
                                   [&](Index j, const Vec<3>&, double) { reported.push_back(j); });
        }
        shake(particles, 0.003, 10 + step);
      }
      return reported;
    });
  };
  const auto one = run(1);
  EXPECT_TRUE(run(2) == one);
  EXPECT_TRUE(run(4) == one);
}

TEST(NeighbourList, RejectsAPeriodicSideShorterThanTwiceRadiusPlusSkin) {
  auto box = cube<2, double>(0, 1);
  box.periodic[0] = true;
  auto particles = particles_at(random_points(5, box, 1), box);
  NeighbourList<2> with_skin{{.radius = 0.45, .skin_fraction = 0.2}};
  EXPECT_TRUE(refuses([&] { with_skin.update(particles); },
                      {"periodic side 1 m along axis 0", "radius plus skin, 2 (0.45 m + 0.09 m)",
                       "smaller skin"}));
  NeighbourList<2> without_skin{{.radius = 0.45, .skin_fraction = 0}};
  without_skin.update(particles);
  without_skin.set_radius(0.55);
  EXPECT_TRUE(refuses([&] { without_skin.update(particles); },
                      {"twice the search radius 0.55 m; enlarge the box"}));
}

TEST(NeighbourList, RejectsInvalidSkins) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refuses([] { NeighbourList<2>({.radius = 1, .skin_fraction = -0.1}); },
                      {"skin_fraction = -0.1"}));
  EXPECT_TRUE(refuses([&] { NeighbourList<2>({.radius = 1, .skin_fraction = nan}); },
                      {"skin_fraction = nan"}));
}

}  // namespace
}  // namespace silt::test::neighbour_list_test
