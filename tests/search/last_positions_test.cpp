// SPDX-License-Identifier: MIT
// The positions of the last update of a search, of owned particles and ghosts.
#include <silt/core/particles.hpp>
#include <silt/core/transfer.hpp>
#include <silt/search/last_positions.hpp>

#include "support/check.hpp"
#include "support/reads_these.hpp"
#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace silt::test::last_positions_test {
namespace {

using Points = Particles<2, double>;

Points two_points() {
  Points points(Box<2>{.lower = {0, 0}, .upper = {1, 1}, .periodic = {true, false}});
  points.add({0.1, 0.5});
  points.add({0.9, 0.5});
  return points;
}

template <class Positions>
void expect_positions(const Positions& positions, const Points& points) {
  const auto x = points.with_ghosts(position);
  for (Index i = 0; i < points.total(); ++i) EXPECT_EQ(positions[i], x[i]) << i;
}

TEST(LastPositions, AreAlsoThoseOfMoreOrFewerGhosts) {
  auto points = two_points();
  LastPositions<2, double> positions;
  positions.update_all(points);
  for (const Index ghosts : {Index(2), Index(50), Index(1)}) {
    points.clear_ghosts();
    for (Index g = 0; g < ghosts; ++g) points.add_ghost(0, {double(g + 1), 0});
    ASSERT_TRUE(positions.update_local(points));
    positions.update_ghosts(points);
    expect_positions(positions, points);
  }
}

TEST(LastPositions, MeasureDisplacementsAcrossAPeriodicSide) {
  auto points = two_points();
  LastPositions<2, double> positions;
  EXPECT_FALSE(positions.update_local(points)) << "they belong to no particles";
  positions.update_all(points);
  points[position][1] = {0.05, 0.5};
  EXPECT_NEAR(*positions.update_local(points), 0.15, 1e-15);
  EXPECT_EQ(*positions.update_local(points), 0);
  points.add({0.3, 0.3});
  EXPECT_FALSE(positions.update_local(points)) << "one was added";
}

TEST(LastPositions, AreRolledBackWithTheirParticles) {
  auto points = two_points();
  LastPositions<2, double> positions;
  positions.update_all(points);
  const auto before = points;
  positions.save();
  points[position][0] = {0.2, 0.2};
  ASSERT_TRUE(positions.update_local(points));
  positions.update_ghosts(points);
  expect_positions(positions, points);
  positions.restore();
  expect_positions(positions, before);
  EXPECT_TRUE(positions.belong_to(points));
}

TEST(LastPositions, RejectInvalidOnesFromACheckpoint) {
  Points particles;
  particles.add({0, 0});
  particles.add({1, 0});
  const std::vector<Vec<2>> x{{0, 0}, {std::numeric_limits<double>::quiet_NaN(), 0}};
  EXPECT_TRUE(refuses([&] { at_positions(particles, x, [] { ADD_FAILURE(); }); },
                      {"search: position of the last update", "nan"}));
  ReadsThese archive({{"is_known", false}, {"positions", std::vector<Vec<2>>{{0, 0}, {1, 0}}}});
  const auto read = [&] {
    transfer_update(
        archive, particles, true, [](Index) { return Vec<2>(0, 0); }, [] { ADD_FAILURE(); });
  };
  EXPECT_TRUE(refuses(read, {"search: is_known = 0, but there are 2 positions"}));
}

}  // namespace
}  // namespace silt::test::last_positions_test
