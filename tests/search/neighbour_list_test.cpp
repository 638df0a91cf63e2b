// SPDX-License-Identifier: MIT
#include "support/check.hpp"
#include "support/points.hpp"

#include <silt/search/neighbour_list.hpp>

#include <gtest/gtest.h>

#include <limits>

namespace silt::test {
namespace {

// A line of three with room between, and a list that sees 1 m with 20 % skin.
Particles<2, double> three() { return particles_at<2, double>({{0, 0}, {0.9, 0}, {2.15, 0}}); }
NeighbourList<2> list() { return NeighbourList<2>({.radius = 1, .skin_fraction = 0.2}); }

TEST(NeighbourList, IsBuiltOnceWhileNobodyMoves) {
  auto particles = three();
  auto found = list();
  for (int k = 0; k < 10; ++k) found.update(particles);
  EXPECT_EQ(found.rebuilds(), 1u);
}

TEST(NeighbourList, IsReusedUntilSomebodyMovedHalfTheSkin) {
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

TEST(NeighbourList, SeesWhatCameWithinTheRadiusWithoutARebuild) {
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

TEST(NeighbourList, IsRebuiltWhenParticlesComeGoOrChangePlaces) {
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

TEST(NeighbourList, WithoutSkinIsRebuiltAtEveryMove) {
  auto particles = three();
  NeighbourList<2> found({.radius = 1, .skin_fraction = 0});
  found.update(particles);
  particles[position][0][0] += 1e-9;
  found.update(particles);
  EXPECT_EQ(found.rebuilds(), 2u);
}

TEST(NeighbourList, ServesOneSetOfParticlesAfterAnother) {
  auto near = particles_at<2, double>({{0, 0}, {0.5, 0}, {10, 0}});
  auto apart = particles_at<2, double>({{0, 0}, {5, 0}, {5.5, 0}});
  auto found = list();
  found.update(near);
  found.update(apart);
  EXPECT_EQ(meetings(apart, found), meetings_by_hand(apart, 1.0));
}

TEST(NeighbourList, RefusesASkinThatIsNoFraction) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refuses([] { NeighbourList<2>({.radius = 1, .skin_fraction = -0.1}); },
                      {"skin_fraction = -0.1"}));
  EXPECT_TRUE(
      refuses([&] { NeighbourList<2>({.radius = 1, .skin_fraction = nan}); }, {"skin_fraction = nan"}));
}

}  // namespace
}  // namespace silt::test
