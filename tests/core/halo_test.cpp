// SPDX-License-Identifier: MIT
// A halo made by hand, in one process: parts of the particles, each with those of the other parts
// that are near, find the same pairs as all particles together.
#include "support/points.hpp"

#include <silt/silt.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

namespace silt::test::halo_test {
namespace {

template <int Dim>
using Points = Particles<Dim, double, velocity_t>;
using Pairs = std::multiset<std::pair<Id, Id>>;

template <int Dim>
Points<Dim> all_points(const Box<Dim, double>& box, Index n) {
  Points<Dim> all(box);
  for (const auto& x : random_points(n, box, 1)) all.add(x);
  return all;
}

// The part whose particles have this number, with those that are closer than the depth to one of
// them as halo.
template <int Dim>
Points<Dim> part_of(const Points<Dim>& all, const std::vector<int>& part_of_particle, int part,
                    double depth) {
  Points<Dim> own(all.box());
  const NearestImage<Dim, double> image(all.box());
  std::vector<Id> others;
  for (Index i = 0; i < all.size(); ++i) {
    if (part_of_particle[i] == part) {
      const Index k = own.adopt(all.id(i));
      own[position][k] = all[position][i];
      continue;
    }
    bool is_near = false;
    for (Index j = 0; j < all.size() && !is_near; ++j) {
      is_near = part_of_particle[j] == part &&
                image(Vec<Dim>(all[position][j] - all[position][i])).norm() < depth;
    }
    if (is_near) others.push_back(all.id(i));
  }
  own.set_halo(others);
  const auto x = own.halo_to_change(position);
  for (Index k = 0; k < others.size(); ++k) x[own.size() + k] = all[position][all.index_of(others[k])];
  return own;
}

template <class P>
void add_pairs(const P& particles, const auto& search, double radius, Pairs& pairs) {
  for (Index i = 0; i < particles.size(); ++i) {
    search.for_each_neighbour(i, [&](Index j, const auto&, double r) {
      EXPECT_LT(r, radius);
      pairs.insert({particles.id(i), particles.id(j)});
    });
  }
}

template <int Dim, template <int> class Search>
void expect_same_neighbours(const Box<Dim, double>& box) {
  const double radius = 0.13;
  Points<Dim> all = all_points<Dim>(box, 300);
  BruteForce<Dim> reference({.radius = radius});
  reference.update(all);
  Pairs expected;
  add_pairs(all, reference, radius, expected);

  // Also a part without particles, and one of particles that lie anywhere.
  std::vector<int> parts(all.size());
  for (Index i = 0; i < all.size(); ++i) {
    parts[i] = i % 10 == 0 ? 4 : all.with_ghosts(position)[i][0] < 0.3 ? 0 : i % 3 == 0 ? 1 : 3;
  }
  Pairs found;
  for (int part = 0; part < 5; ++part) {
    auto own = part_of<Dim>(all, parts, part, radius);
    Search<Dim> search({.radius = radius});
    search.update(own);
    add_pairs(own, search, radius, found);
  }
  EXPECT_EQ(found, expected);
}
template <int Dim>
using BruteForceOf = BruteForce<Dim>;
template <int Dim>
using UniformGridOf = UniformGrid<Dim>;
template <int Dim>
using NeighbourListOf = NeighbourList<Dim>;

TEST(Halo, GivesTheNeighboursOfAllParticlesTogether) {
  const Box<2, double> plane{.lower = {0, 0}, .upper = {1, 1}};
  const Box<3, double> space{.lower = {0, 0, 0}, .upper = {1, 1, 1}};
  expect_same_neighbours<2, BruteForceOf>(plane);
  expect_same_neighbours<2, UniformGridOf>(plane);
  expect_same_neighbours<2, NeighbourListOf>(plane);
  expect_same_neighbours<3, BruteForceOf>(space);
  expect_same_neighbours<3, UniformGridOf>(space);
  expect_same_neighbours<3, NeighbourListOf>(space);
}
TEST(Halo, GivesThemAcrossPeriodicSides) {
  const Box<2, double> plane{.lower = {0, 0}, .upper = {1, 1}, .periodic = {true, true}};
  const Box<3, double> space{
      .lower = {0, 0, 0}, .upper = {1, 1, 1}, .periodic = {true, false, true}};
  expect_same_neighbours<2, BruteForceOf>(plane);
  expect_same_neighbours<2, UniformGridOf>(plane);
  expect_same_neighbours<2, NeighbourListOf>(plane);
  expect_same_neighbours<3, UniformGridOf>(space);
  expect_same_neighbours<3, NeighbourListOf>(space);
}

Points<2> two_with_halo() {
  Points<2> points;
  points.adopt(7);
  points.adopt(3);
  points[position][0] = Vec<2>(0, 0);
  points[position][1] = Vec<2>(1, 0);
  points.set_halo(std::vector<Id>{9, 5});
  points.halo_to_change(position)[2] = Vec<2>(2, 0);
  points.halo_to_change(position)[3] = Vec<2>(3, 0);
  return points;
}
TEST(Halo, IsBehindTheOwnedParticles) {
  const auto points = two_with_halo();
  EXPECT_EQ(points.size(), 2U);
  EXPECT_EQ(points.local(), 4U);
  EXPECT_EQ(points.total(), 4U);
  EXPECT_EQ(points.index_of(3), 1U);
  EXPECT_EQ(points.index_of(5), 3U);
  EXPECT_EQ(points.owner(3), 3U);
  EXPECT_EQ(points.with_halo(position)[3], Vec<2>(3, 0));
  EXPECT_EQ(points[position].size(), 2U);
}
TEST(Halo, StaysWhenOwnedParticlesAreReordered) {
  auto points = two_with_halo();
  points.reorder(std::vector<Index>{1, 0});
  EXPECT_EQ(points.id(0), 3U);
  EXPECT_EQ(points.index_of(5), 3U);
  EXPECT_EQ(points.with_halo(position)[3], Vec<2>(3, 0));
}
TEST(Halo, StaysWhenOwnedParticlesAreRemoved) {
  auto points = two_with_halo();
  points.remove(7);
  EXPECT_EQ(points.size(), 1U);
  EXPECT_EQ(points.index_of(5), 2U);
  EXPECT_EQ(points.with_halo(position)[2], Vec<2>(3, 0));
}
TEST(Halo, IsRemovedWhenParticlesAreAdded) {
  auto others = two_with_halo();
  EXPECT_EQ(others.id(others.add({4, 0})), 10U);
  EXPECT_EQ(others.total(), 3U);
}
TEST(Halo, IsAsBeforeAfterAFailedStep) {
  auto points = two_with_halo();
  points.save();
  const auto x = points.advance(position);
  for (Index i = 0; i < 2; ++i) x.after[i] = x.before[i] + Vec<2>(0, 1);
  points.finish_advance(1);
  points.restore();
  EXPECT_EQ(points[position][1], Vec<2>(1, 0));
  EXPECT_EQ(points.with_halo(position)[3], Vec<2>(3, 0));
}
TEST(Halo, RefusesAParticleThatIsHere) {
  auto points = two_with_halo();
  EXPECT_THROW(points.set_halo(std::vector<Id>{1, 3}), Error);
  EXPECT_EQ(points.total(), 2U);
  EXPECT_EQ(points.index_of(1), no_index);
  EXPECT_THROW(points.adopt(3), Error);
}

}  // namespace
}  // namespace silt::test::halo_test
