// SPDX-License-Identifier: MIT
#include "support/check.hpp"
#include "support/grains.hpp"
#include "support/reads_these.hpp"

#include <silt/measure/profiles.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <span>
#include <utility>
#include <vector>

namespace silt::test::profiles_test {
namespace {

constexpr double pi = std::numbers::pi;

TEST(BlockSums, EstimateTheErrorOfIndependentSamples) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal(3, 2);
  BlockSums sums(2);
  constexpr int n = 10000;
  for (int k = 0; k < n; ++k) {
    const double x = normal(random);
    sums.add(std::vector<double>{x, 1});
  }
  EXPECT_EQ(sums.samples(), Index(n));
  EXPECT_GE(sums.blocks(), 16u);
  EXPECT_LT(sums.blocks(), 32u);
  const Estimate mean = sums.mean(0);
  EXPECT_NEAR(mean.value, 3, 4 * 0.02);
  EXPECT_NEAR(mean.standard_error, 2 / std::sqrt(n), 0.5 * 2 / std::sqrt(n));
  EXPECT_EQ(sums.mean(1).value, 1);
  EXPECT_EQ(sums.mean(1).standard_error, 0);
}

TEST(BlockSums, EstimateTheErrorOfCorrelatedSamples) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> normal(0, 1);
  BlockSums sums(1);
  for (int k = 0; k < 100; ++k) {
    const double x = normal(random);
    for (int again = 0; again < 64; ++again) sums.add(std::vector<double>{x});
  }
  EXPECT_NEAR(sums.mean(0).standard_error, 0.1, 0.05) << "the error of 100 samples, not of 6400";
}

TEST(BlockSums, HaveNoErrorForOneSample) {
  BlockSums sums(1);
  sums.add(std::vector<double>{5});
  EXPECT_EQ(sums.mean(0).value, 5);
  EXPECT_TRUE(std::isinf(sums.mean(0).standard_error));
  EXPECT_TRUE(refuses([&] { sums.add(std::vector<double>{1, 2}); }, {"BlockSums", "2", "1"}));
}

TEST(SliceOfAGrain, HasTheExactVolume) {
  EXPECT_NEAR(sphere_volume_below(2, 2), 4 * pi / 3 * 8, 1e-13);
  EXPECT_NEAR(sphere_volume_below(2, 0), 2 * pi / 3 * 8, 1e-13);
  EXPECT_NEAR(sphere_volume_below(2, -1), pi * (3 * 2 - 1) / 3, 1e-13) << "a cap of height 1";
  EXPECT_NEAR(sphere_volume_below(2, -3), 0, 1e-13);
  EXPECT_NEAR(disc_area_below(2, 9), pi * 4, 1e-13);
  EXPECT_NEAR(disc_area_below(2, 1), pi * 4 - (4 * std::acos(0.5) - std::sqrt(3)), 1e-13);
}

TEST(Profiles, OfASimpleCubicLatticeAreExact) {
  constexpr double d = 0.1;
  auto grains = dem::make_grains(lattice<3>({{0, 0, 0}, {0.4, 0.4, 0.4}}, d),
                                 {.radius = d / 2, .density = 1});
  ASSERT_EQ(grains.size(), 64u);
  Profiles<3> quarters({.lower = 0, .upper = 0.4, .count = 16, .cross_section = 0.16});
  quarters.add(grains);
  const double cap = pi * squared(d / 4) * (3 * d / 2 - d / 4) / 3 / (d * d * d);  // per cell
  const auto rows = quarters.rows();
  ASSERT_EQ(rows.size(), 16u);
  for (Index s = 0; s < 16; ++s) {
    const bool outer = s % 4 == 0 || s % 4 == 3;
    EXPECT_NEAR(rows[s].height, (double(s) + 0.5) * d / 4, 1e-15);
    EXPECT_NEAR(rows[s].solid_fraction.value, 4 * (outer ? cap : pi / 12 - cap), 1e-12) << s;
    EXPECT_NEAR(rows[s].temperature.value, 0, 1e-15);
  }
}

TEST(Profiles, EvaluateFunctionsOfAllSolidFractions) {
  Profiles<2> profiles({.lower = 0, .upper = 1, .count = 4, .cross_section = 1});
  for (const double height : {0.2, 0.3, 0.2, 0.3}) {
    profiles.add(one_grain<2>({0, height}, {0, 0}, {.radius = 0.1, .density = 1}));
  }
  const Estimate sum = profiles.of_solid_fractions([](std::span<const double> fractions) {
    return std::accumulate(fractions.begin(), fractions.end(), 0.0) / 4;
  });
  EXPECT_NEAR(sum.value, pi * 0.01, 1e-15);
  EXPECT_NEAR(sum.standard_error, 0, 1e-15) << "the sum is the volume of the grain in each sample";
}

TEST(Profiles, IncludeImagesAcrossAPeriodicHeight) {
  Box<2> box{.lower = {0, 0}, .upper = {1, 1}, .periodic = {true, true}};
  dem::Grains<2> grain(box);
  dem::add_grain(grain, {0.5, 0.01}, {.radius = 0.1, .density = 1});
  Profiles<2> profiles({.lower = 0, .upper = 1, .count = 5, .cross_section = 1});
  profiles.add(grain);
  const auto rows = profiles.rows();
  double sum = 0;
  for (const auto& row : rows) sum += row.solid_fraction.value / 5;
  EXPECT_NEAR(sum, pi * 0.01, 1e-15);
  EXPECT_NEAR(rows[4].solid_fraction.value * 0.2, disc_area_below(0.1, -0.01), 1e-15);
  EXPECT_TRUE(std::isnan(rows[2].temperature.value)) << "the slice was empty";
}

TEST(Profiles, SeparateFluctuationsFromTheMeanFlow) {
  Profiles<3> profiles({.lower = 0, .upper = 1, .count = 1, .cross_section = 2});
  // A mean flow of (1, 0, 0) by mass, and fluctuations about it.
  dem::Grains<3> grains;
  dem::add_grain(grains, {0, 0, 0.3}, {.radius = 0.1, .density = 200});
  dem::add_grain(grains, {1, 0, 0.7}, {.radius = 0.1, .density = 100});
  for (const double sign : {1.0, -1.0}) {
    grains[velocity][0] = {1, 0, sign};
    grains[velocity][1] = {1, 3 * sign, -2 * sign};
    profiles.add(grains);
  }
  const auto row = profiles.rows().at(0);
  EXPECT_NEAR(row.velocity[0].value, 1, 1e-14);
  EXPECT_NEAR(row.velocity[1].value, 0, 1e-14);
  EXPECT_NEAR(row.component[0].value, 0, 1e-14);
  EXPECT_NEAR(row.component[1].value, 3, 1e-13);
  EXPECT_NEAR(row.component[2].value, (2 * 1 + 1 * 4) / 3.0, 1e-13);
  EXPECT_NEAR(row.temperature.value, (3 + 2) / 3.0, 1e-13);
}

TEST(Profiles, AreAnObserverOfRuns) {
  auto grain = one_grain<2>({0, 0.5}, {0.25, 0});
  Simulation sim{grain, UniformGrid<2>{}, Forces{}, Leapfrog{}};
  Profiles<2> profiles({.lower = 0, .upper = 1, .count = 1, .cross_section = 1});
  sim.run({.until = 1, .output_every = 0.1, .time_step = 0.01}, profiles);
  EXPECT_EQ(profiles.samples(), 11u);
  EXPECT_NEAR(profiles.rows()[0].velocity[0].value, 0.25, 1e-14);
  EXPECT_EQ(profiles.rows()[0].solid_fraction.standard_error, 0);
}

TEST(Profiles, RejectSlicesWithoutVolume) {
  EXPECT_TRUE(refuses([] { Profiles<2>({.lower = 1, .upper = 1, .count = 1, .cross_section = 1}); },
                      {"Slices: upper - lower"}));
  EXPECT_TRUE(refuses([] { Profiles<2>({.lower = 0, .upper = 1, .count = 0, .cross_section = 1}); },
                      {"Slices: count"}));
  EXPECT_TRUE(refuses([] { Profiles<2>({.lower = 0, .upper = 1, .count = 1}); },
                      {"Slices: cross_section"}));
}

TEST(Profiles, RejectSamplesOfOthersFromACheckpoint) {
  Profiles<2> profiles({.lower = 0, .upper = 1, .count = 2, .cross_section = 1});
  EXPECT_TRUE(refuses([&] { profiles.rows(); }, {"Profiles: there are 0 samples"}));

  const auto read = [](std::vector<double> current, Index in_current) {
    BlockSums sums(2);
    ReadsThese archive({{"blocks", std::vector<double>{}},
                        {"current", std::move(current)},
                        {"in_current", in_current},
                        {"block_length", Index(4)},
                        {"samples", in_current}});
    sums.transfer(archive);
  };
  read({1, 2}, 3);
  EXPECT_TRUE(refuses([&] { read({1}, 3); }, {"BlockSums", "samples of 1 values, not 2"}));
  EXPECT_TRUE(refuses([&] { read({1, 2}, 4); }, {"BlockSums: in_current = 4 is not below"}));
}

}  // namespace
}  // namespace silt::test::profiles_test
