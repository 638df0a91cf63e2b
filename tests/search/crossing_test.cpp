// SPDX-License-Identifier: MIT
// A particle that crosses a periodic side between two updates does not end the validity of a
// neighbour list.
#include <silt/core/particles.hpp>
#include <silt/search/brute_force.hpp>
#include <silt/search/neighbour_list.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>
#include <utility>

namespace silt::test::crossing_test {
namespace {

template <class P>
std::set<std::pair<Id, Id>> pairs_by_list(const P& particles, const NeighbourList<2>& list) {
  std::set<std::pair<Id, Id>> pairs;
  list.for_each_pair([&](Index i, Index j, const Vec<2>& r_ij, double r) {
    EXPECT_NEAR(r_ij.norm(), r, 1e-12);
    EXPECT_TRUE(
        pairs.insert(std::minmax(particles.id(i), particles.id(particles.owner(j)))).second);
  });
  std::set<std::pair<Id, Id>> neighbours;
  for (Index i = 0; i < particles.size(); ++i) {
    list.for_each_neighbour(i, [&](Index j, const Vec<2>&, double) {
      neighbours.insert(std::minmax(particles.id(i), particles.id(particles.owner(j))));
    });
  }
  EXPECT_EQ(neighbours, pairs);
  return pairs;
}

TEST(NeighbourList, IsKeptWhenParticlesCrossAPeriodicSide) {
  Box<2> box{.lower = {0, 0}, .upper = {1, 1}};
  box.periodic = {true, true};
  Particles<2, double> particles(box);
  std::mt19937 random(3);
  const auto uniform = [&] { return double(random()) / (double(std::mt19937::max()) + 1); };
  for (int k = 0; k < 300; ++k) particles.add({uniform(), uniform()});
  NeighbourList<2> list{{.radius = 0.1, .skin_fraction = 0.5}};
  Index crossings = 0;
  for (int step = 0; step < 30; ++step) {
    list.update(particles);
    std::set<std::pair<Id, Id>> expected;
    const auto x = particles[position];
    for (Index i = 0; i < particles.size(); ++i) {
      for (Index j = i + 1; j < particles.size(); ++j) {
        Vec<2> r = x[j] - x[i];
        for (int k = 0; k < 2; ++k) r[k] -= std::round(r[k]);
        if (r.norm() < 0.1) expected.insert({i, j});
      }
    }
    ASSERT_EQ(pairs_by_list(particles, list), expected) << "step " << step;
    for (auto& each : particles[position]) {
      const Vec<2> moved = each + Vec<2>(0.004, 0.002);
      each = box.wrap(moved);
      crossings += each != moved;
    }
  }
  EXPECT_GT(crossings, 20u);
  EXPECT_LT(list.rebuilds(), 10u);
}

}  // namespace
}  // namespace silt::test::crossing_test
