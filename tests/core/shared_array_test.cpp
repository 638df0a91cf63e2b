// SPDX-License-Identifier: MIT
// Proves, as no other test does, that a SharedArray is replaced, not changed, while another owner
// has its values, and that its memory is used again when none has.
#include <silt/core/shared_array.hpp>

#include <gtest/gtest.h>

#include <vector>

namespace silt::test::shared_array_test {
namespace {

std::vector<double> values_of(const SharedArray<double>& array) {
  return {array.begin(), array.end()};
}
SharedArray<double> array_of(const std::vector<double>& values) {
  SharedArray<double> array;
  array.assign(values.begin(), values.end());
  return array;
}

TEST(SharedArray, IsNotChangedForItsOtherOwners) {
  const SharedArray<double> kept = array_of({1, 2, 3});
  auto changed = kept;
  EXPECT_EQ(changed.data(), kept.data());
  changed.renew(3)[0] = 4;
  auto longer = kept;
  longer.reserve_own(4);
  longer.push_back(5);
  auto begun = kept.first(2);
  *begun.resize(3) = 6;
  EXPECT_EQ(changed[0], 4);
  EXPECT_EQ(values_of(longer), (std::vector<double>{1, 2, 3, 5}));
  EXPECT_EQ(begun[0], 6);
  EXPECT_EQ(begun[1], 2);
  EXPECT_EQ(values_of(kept), (std::vector<double>{1, 2, 3}));
}

TEST(SharedArray, UsesItsMemoryAgainWithoutOtherOwners) {
  auto array = array_of({1, 2, 3});
  const double* const memory = array.data();
  EXPECT_EQ(array.renew(2), memory);
  {
    const auto other = array;
  }
  EXPECT_EQ(array.resize(3), memory);
}

TEST(SharedArray, TakesTheMemoryOfAnotherOnlyIfTheBitsAreTheSame) {
  const auto other = array_of({0.0, 2});
  SharedArray<double> array;
  const std::vector<double> zero{0.0, 2};
  array.assign(zero.begin(), zero.end(), other);
  EXPECT_EQ(array.data(), other.data());
  for (const auto& values : {std::vector<double>{-0.0, 2}, {0.0}, {0.0, 2, 3}}) {
    array.assign(values.begin(), values.end(), other);
    EXPECT_NE(array.data(), other.data());
    EXPECT_EQ(values_of(array), values);
  }
}

TEST(SharedArray, HasTheFirstOfItsValuesWhenTheOthersAreGone) {
  auto array = array_of({1, 2, 3});
  array = array.first(1);
  array.push_back(7);
  EXPECT_EQ(values_of(array), (std::vector<double>{1, 7}));
  EXPECT_EQ(array.first(5).size(), 2u);
}

}  // namespace
}  // namespace silt::test::shared_array_test
