// SPDX-License-Identifier: MIT
// Proves, as no other test does, what silt::Buffer promises by itself: values that are bytes and
// values that own something are copied, moved and kept as by std::vector, also if a copy fails.
#include <silt/core/buffer.hpp>

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt::test::buffer_test {
namespace {

template <class T>
T value_of(int number) {
  if constexpr (std::is_same_v<T, std::string>) {
    return "a text that is longer than a small one, number " + std::to_string(number);
  } else {
    return T(number);
  }
}
template <class T>
std::vector<T> values_of(int count) {
  std::vector<T> values;
  for (int k = 0; k < count; ++k) values.push_back(value_of<T>(k));
  return values;
}
template <class T>
void expect_equal(const Buffer<T>& buffer, const std::vector<T>& values) {
  EXPECT_EQ(std::vector<T>(buffer.begin(), buffer.end()), values);
}

template <class T>
class Buffers : public ::testing::Test {};
using Values = ::testing::Types<std::uint32_t, std::string>;
TYPED_TEST_SUITE(Buffers, Values);

TYPED_TEST(Buffers, HaveTheValuesOfAVectorAfterTheSameChanges) {
  using T = TypeParam;
  Buffer<T> buffer;
  std::vector<T> vector;
  const auto change = [&](auto&& f) {
    f(buffer);
    f(vector);
    expect_equal(buffer, vector);
  };
  const auto more = values_of<T>(50);
  change([](auto& v) { v.resize(3); });
  for (int k = 0; k < 100; ++k) change([k](auto& v) { v.push_back(value_of<T>(k)); });
  change([](auto& v) { v.pop_back(); });
  change([](auto& v) { v.push_back(v.front()); });
  change([](auto& v) { v.push_back(v.back()); });
  change([](auto& v) { v.resize(200, v[1]); });
  change([](auto& v) { v.resize(7); });
  change([](auto& v) { v.assign(300, v[2]); });
  change([&](auto& v) { v.assign(more.begin(), more.end()); });
  change([](auto& v) { v.clear(); });
}

TYPED_TEST(Buffers, AreIndependentOfTheirCopies) {
  using T = TypeParam;
  const auto values = values_of<T>(20);
  Buffer<T> first(values.begin(), values.end());
  Buffer<T> copy(first);
  Buffer<T> assigned(3, value_of<T>(1));
  assigned = first;
  Buffer<T>& itself = first;
  first = itself;
  first[0] = value_of<T>(99);
  expect_equal(copy, values);
  expect_equal(assigned, values);
  const Buffer<T> moved = std::move(copy);
  assigned = std::move(first);
  expect_equal(moved, values);
  EXPECT_EQ(assigned[0], value_of<T>(99));
}

TEST(Buffer, BeginsAtACacheLine) {
  for (Index count = 1; count < 40; ++count) {
    Buffer<char> buffer(count);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(buffer.data()) % 64, 0u);
  }
}

struct FailsToBeCopied {
  std::shared_ptr<int> counted;
  int* left;

  FailsToBeCopied(std::shared_ptr<int> shared, int& copies) : counted(shared), left(&copies) {}
  FailsToBeCopied(const FailsToBeCopied& other) : counted(other.counted), left(other.left) {
    if ((*left)-- == 0) throw std::runtime_error("no further copy");
  }
  FailsToBeCopied(FailsToBeCopied&&) noexcept = default;
};

TEST(Buffer, KeepsItsValuesAndLosesNoneIfACopyFails) {
  const auto counted = std::make_shared<int>(0);
  int copies = 1000;
  {
    Buffer<FailsToBeCopied> from, to;
    for (int k = 0; k < 9; ++k) from.emplace_back(counted, copies);
    for (int k = 0; k < 5; ++k) to.emplace_back(counted, copies);
    copies = 4;
    EXPECT_THROW(to = from, std::runtime_error);
    copies = 4;
    EXPECT_THROW(Buffer<FailsToBeCopied>{from}, std::runtime_error);
    EXPECT_EQ(to.size(), 5u);
    EXPECT_EQ(counted.use_count(), 1 + 9 + 5);
  }
  EXPECT_EQ(counted.use_count(), 1);
}

}  // namespace
}  // namespace silt::test::buffer_test
