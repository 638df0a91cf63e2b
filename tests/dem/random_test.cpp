// SPDX-License-Identifier: MIT
#include <silt/dem/setup/random.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace silt::test::random_test {
namespace {

// Test vectors published by the authors of Philox.
TEST(Random, IsPhilox) {
  using Block = std::array<std::uint32_t, 4>;
  EXPECT_EQ(detail::philox({0, 0, 0, 0}, {0, 0}),
            (Block{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  constexpr std::uint32_t ones = ~std::uint32_t(0);
  EXPECT_EQ(detail::philox({ones, ones, ones, ones}, {ones, ones}),
            (Block{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(
      detail::philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
      (Block{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

TEST(Random, BeginsWithZeros) {
  EXPECT_EQ(Random{}.uniform(), (Random{.seed = 0, .id = 0, .counter = 0}.uniform()));
}

TEST(Random, ContinuesFromItsThreeNumbers) {
  Random whole{.seed = 7, .id = 3};
  std::vector<double> numbers;
  for (int k = 0; k < 10; ++k) numbers.push_back(whole.uniform());
  for (std::uint64_t k = 0; k < 10; ++k) {
    Random later{.seed = 7, .id = 3, .counter = k};
    EXPECT_EQ(later.uniform(), numbers[k]);
  }
  Random of_another{.seed = 7, .id = 4};
  Random of_another_run{.seed = 8, .id = 3};
  EXPECT_NE(of_another.uniform(), numbers[0]);
  EXPECT_NE(of_another_run.uniform(), numbers[0]);
}

// Variance, and maximum distance of the distribution function from the exact one (Kolmogorov and
// Smirnov: above 1.63/√n with a probability of 1 %).
template <class Draw, class Share>
void expect_distribution(const Draw& draw, double variance, const Share& share_below) {
  constexpr Index n = 20000;
  std::vector<double> values;
  for (Id id = 0; id < n; ++id) {
    Random random{.seed = 1, .id = id};
    values.push_back(draw(random));
  }
  std::sort(values.begin(), values.end());
  double mean = 0, square = 0, distance = 0;
  for (Index k = 0; k < n; ++k) {
    mean += values[k] / n;
    square += values[k] * values[k] / n;
    distance = std::max(distance, std::abs((double(k) + 0.5) / n - share_below(values[k])));
  }
  EXPECT_LT(distance, 1.63 / std::sqrt(n));
  EXPECT_NEAR(square - mean * mean, variance, 0.03 * variance);
}

TEST(Random, IsUniformOverIds) {
  expect_distribution([](Random& random) { return random.uniform(); }, 1.0 / 12,
                      [](double x) { return x; });
}

TEST(Random, IsNormalOverIds) {
  expect_distribution([](Random& random) { return random.normal(); }, 1.0,
                      [](double x) { return std::erfc(-x / std::sqrt(2.0)) / 2; });
}

TEST(Random, FillsABoxUniformly) {
  const Box<3> box{.lower = {-1, 0, 2}, .upper = {1, 1, 4}};
  Random random{.seed = 2};
  Vec<3> mean = Vec<3>::Zero();
  constexpr int n = 10000;
  for (int k = 0; k < n; ++k) {
    const Vec<3> x = random.point_in(box);
    ASSERT_TRUE(box.contains(x));
    mean += x / n;
  }
  EXPECT_LT((mean - Vec<3>(0, 0.5, 3)).norm(), 0.02);
}

}  // namespace
}  // namespace silt::test::random_test
