// SPDX-License-Identifier: MIT
// Compares packs with scalar code, for every width on every processor; processors differ in the
// widths for which they have instructions.
#include <silt/core/simd.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <type_traits>

// As in core/simd.hpp: packs wider than a register are passed in memory.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace silt::test::simd_test {
namespace {

template <class T, int N>
struct Lanes {
  using Number = T;
  static constexpr int number = N;
};

template <class Of>
class Registers : public ::testing::Test {
 protected:
  using Number = typename Of::Number;
  using Values = std::array<Number, Of::number>;

  // Numbers that are often equal, and sometimes NaN or infinite.
  Values next() {
    Values values;
    for (Number& value : values) {
      value = static_cast<Number>(random_() % 5);
      if constexpr (std::is_floating_point_v<Number>) {
        if (random_() % 8 == 0) value = std::numeric_limits<Number>::quiet_NaN();
        if (random_() % 8 == 0) value = std::numeric_limits<Number>::infinity();
      }
    }
    return values;
  }
  std::uint32_t bits() { return static_cast<std::uint32_t>(random_()); }

  template <class Test>
  static simd::Mask mask_of(Test&& test) {
    simd::Mask mask = 0;
    for (std::size_t k = 0; k < Of::number; ++k) mask |= static_cast<simd::Mask>(test(k)) << k;
    return mask;
  }

 private:
  std::mt19937 random_{1};
};

template <class Of>
class RealRegisters : public Registers<Of> {};
using RealLanes = ::testing::Types<Lanes<float, 4>, Lanes<float, 8>, Lanes<float, 16>,
                                   Lanes<double, 2>, Lanes<double, 4>, Lanes<double, 8>>;
TYPED_TEST_SUITE(RealRegisters, RealLanes);

TYPED_TEST(RealRegisters, CompareLikeScalars) {
  constexpr int N = TypeParam::number;
  using T = typename TypeParam::Number;
  for (int trial = 0; trial < 500; ++trial) {
    const auto a = this->next();
    const auto b = this->next();
    EXPECT_EQ((simd::less<T, N>(simd::load<T, N>(a.data()), simd::load<T, N>(b.data()))),
              this->mask_of([&](std::size_t k) { return a[k] < b[k]; }));
  }
}

TYPED_TEST(RealRegisters, HaveTheSquareRootsOfScalars) {
  constexpr int N = TypeParam::number;
  using T = typename TypeParam::Number;
  for (int trial = 0; trial < 500; ++trial) {
    auto values = this->next();
    for (T& value : values) value *= T(1) + T(this->bits()) * T(1e-9);
    decltype(values) roots;
    simd::store<T, N>(roots.data(), simd::square_root<T, N>(simd::load<T, N>(values.data())));
    for (std::size_t k = 0; k < N; ++k) {
      const T root = std::sqrt(values[k]);
      EXPECT_TRUE(roots[k] == root || (std::isnan(roots[k]) && std::isnan(root)))
          << roots[k] << " of " << values[k];
    }
  }
}

template <class Of>
class IndexRegisters : public Registers<Of> {};
using IndexLanes = ::testing::Types<Lanes<std::uint32_t, 4>, Lanes<std::uint32_t, 8>,
                                    Lanes<std::uint32_t, 16>>;
TYPED_TEST_SUITE(IndexRegisters, IndexLanes);

TYPED_TEST(IndexRegisters, FindTheNumbersThatDiffer) {
  constexpr int N = TypeParam::number;
  for (int trial = 0; trial < 500; ++trial) {
    const auto values = this->next();
    const std::uint32_t other = this->bits() % 5;
    EXPECT_EQ((simd::differs<N>(simd::load<std::uint32_t, N>(values.data()), other)),
              this->mask_of([&](std::size_t k) { return values[k] != other; }));
  }
}

TYPED_TEST(IndexRegisters, WriteTheSelectedNumbersInOrder) {
  constexpr int N = TypeParam::number;
  std::array<std::uint32_t, N> values;
  for (std::uint32_t& value : values) value = this->bits();
  for (std::uint32_t mask = 0; mask < 1u << N; mask += N == 16 ? 37 : 1) {
    std::array<std::uint32_t, N + 1> written;
    written.fill(12345);
    const auto pack = simd::load<std::uint32_t, N>(values.data());
    const Index count = simd::compress<std::uint32_t, N>(written.data(), pack, mask);
    Index expected = 0;
    for (std::size_t k = 0; k < N; ++k) {
      if ((mask >> k & 1) == 0) continue;
      ASSERT_EQ(written[expected], values[k]) << "mask " << mask;
      ++expected;
    }
    ASSERT_EQ(count, expected) << "mask " << mask;
    ASSERT_EQ(written[N], 12345u) << "nothing is written beyond a register";
  }
}

}  // namespace
}  // namespace silt::test::simd_test
