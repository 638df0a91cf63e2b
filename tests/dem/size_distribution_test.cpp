// SPDX-License-Identifier: MIT
#include <silt/dem/setup/size_distribution.hpp>

#include "support/check.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace silt::test::size_distribution_test {
namespace {

template <class Sizes>
std::vector<double> radii(const Sizes& sizes, Index number) {
  std::vector<double> radii;
  for (Id id = 0; id < number; ++id) {
    Random random{.seed = 1, .id = id};
    radii.push_back(sizes.radius(random));
    EXPECT_LE(radii.back(), sizes.largest());
  }
  return radii;
}

// A fraction of n grains has a standard deviation of at most √(1/4n); four of these are exceeded
// once in 16000.
constexpr Index n = 10000;
constexpr double doubt = 4 * 0.5 / 100;

template <class Accepts>
double share(const std::vector<double>& radii, const Accepts& accepts) {
  return double(std::count_if(radii.begin(), radii.end(), accepts)) / double(radii.size());
}

TEST(SizeDistribution, IsUniformBetweenItsLimits) {
  const dem::UniformSizes sizes{.min_radius = 1, .max_radius = 3};
  const auto all = radii(sizes, n);
  EXPECT_EQ(share(all, [](double R) { return R >= 1; }), 1);
  EXPECT_NEAR(share(all, [](double R) { return R < 1.5; }), 0.25, doubt);
}

TEST(SizeDistribution, IsLognormalBetweenItsLimits) {
  const dem::LognormalSizes sizes{
      .median = 1, .deviation = 0.5, .min_radius = 0.5, .max_radius = 2};
  const auto all = radii(sizes, n);
  EXPECT_EQ(share(all, [](double R) { return 0.5 <= R && R <= 2; }), 1);
  const double inside = sizes.share_below(2) - sizes.share_below(0.5);
  for (const double R : {0.7, 1.0, 1.4}) {
    EXPECT_NEAR(share(all, [R](double each) { return each < R; }),
                (sizes.share_below(R) - sizes.share_below(0.5)) / inside, doubt);
  }
}

TEST(SizeDistribution, HasTheMassFractionOfEachSieve) {
  for (const int power : {2, 3}) {
    const dem::SieveSizes sizes({{.min_radius = 0.5, .max_radius = 1, .mass = 20},
                                 {.min_radius = 1, .max_radius = 1.5, .mass = 50},
                                 {.min_radius = 1.5, .max_radius = 2, .mass = 30}},
                                {.power = power});
    double mass[3] = {0, 0, 0};
    for (const double R : radii(sizes, n)) mass[R < 1 ? 0 : R < 1.5 ? 1 : 2] += std::pow(R, power);
    const double all = mass[0] + mass[1] + mass[2];
    EXPECT_NEAR(mass[0] / all, 0.2, doubt);
    EXPECT_NEAR(mass[1] / all, 0.5, doubt);
    EXPECT_NEAR(mass[2] / all, 0.3, doubt);
  }
}

TEST(SizeDistribution, ThrowsForInvalidParameters) {
  EXPECT_TRUE(refuses([] { dem::UniformSizes{.min_radius = 2, .max_radius = 1}.check(); },
                      {"UniformSizes: min_radius = 2 m is above max_radius = 1"}));
  EXPECT_TRUE(refuses([] { dem::EqualSizes{}.check(); }, {"EqualSizes", "positive"}));
  EXPECT_TRUE(refuses(
      [] {
        dem::LognormalSizes{.median = 1, .deviation = 0.1, .min_radius = 4, .max_radius = 5}
            .check();
      },
      {"LognormalSizes: only", "4", "5"}));
  EXPECT_TRUE(refuses([] { dem::SieveSizes({}); }, {"SieveSizes: mass of all fractions"}));
  EXPECT_TRUE(refuses(
      [] { dem::SieveSizes({{.min_radius = 1, .max_radius = 2, .mass = 1}}, {.power = 1}); },
      {"SieveSizes: power = 1"}));
}

TEST(SizeDistribution, ThrowsForSievesWithCountlessGrains) {
  EXPECT_TRUE(refuses(
      [] { dem::SieveSizes({{.min_radius = 1e-75, .max_radius = 2e-75, .mass = 1e100}}); },
      {"SieveSizes: number of grains for these masses"}));
}

}  // namespace
}  // namespace silt::test::size_distribution_test
