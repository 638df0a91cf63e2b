// SPDX-License-Identifier: MIT
// Fabric and distribution of forces of three grains in two directions, exactly, and of a crowd. No
// other test has directions of contacts.
#include <silt/dem/measure/contact_statistics.hpp>

#include "support/check.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <numeric>

namespace silt::test::contact_statistics_test {
namespace {

const dem::CundallStrack law{.normal_stiffness = 1e4, .restitution = 1};

TEST(ContactStatistics, AreExactForThreeGrains) {
  constexpr double R = 0.01;
  dem::Grains<2> grains;
  dem::add_grain(grains, {0, 0}, pebble);
  dem::add_grain(grains, {2 * R - 1e-4, 0}, pebble);
  dem::add_grain(grains, {0, 2 * R - 3e-4}, pebble);
  dem::Contacts contacts{law};
  Simulation sim{grains, UniformGrid<2>{}, contacts, Leapfrog{}};
  sim.step(1e-7);
  const auto state = sim.state();
  const auto all =
      dem::contact_statistics(state.particles, state.interaction, {.width = 1, .number = 2});
  EXPECT_EQ(all.number, 2u);
  EXPECT_NEAR(all.mean_normal_force, 2, 1e-3);  // 1 N and 3 N
  EXPECT_NEAR(all.fabric(0, 0), 0.5, 1e-12);
  EXPECT_NEAR(all.force_fabric(1, 1), 0.75, 1e-4);
  EXPECT_NEAR(all.mobilised_friction, 0, 1e-12);
  EXPECT_EQ(all.density, (std::vector<double>{0.5, 0.5}));
  EXPECT_TRUE(
      refuses([&] { dem::contact_statistics(state.particles, state.interaction, {.width = 0}); },
              {"dem::ForceBins: width = 0"}));
  EXPECT_TRUE(
      refuses([&] { dem::contact_statistics(state.particles, state.interaction, {.number = 0}); },
              {"dem::ForceBins: number = 0"}));
}

TEST(ContactStatistics, OfACrowdHaveNoPreferredDirection) {
  Simulation sim{crowd<2, double>(30, 3), UniformGrid<2>{}, dem::Contacts{law}, Leapfrog{}};
  for (int k = 0; k < 200; ++k) sim.step(1e-5);
  const auto state = sim.state();
  const auto all = dem::contact_statistics(state.particles, state.interaction);
  ASSERT_GT(all.number, 300u);
  EXPECT_NEAR(all.fabric.trace(), 1, 1e-12);
  EXPECT_NEAR(all.fabric(0, 0), 0.5, 0.1);
  EXPECT_NEAR(all.force_fabric.trace(), 1, 1e-12);
  EXPECT_NEAR(std::accumulate(all.density.begin(), all.density.end(), 0.0) * all.bin_width, 1,
              1e-12);
}

}  // namespace
}  // namespace silt::test::contact_statistics_test
