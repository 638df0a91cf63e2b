// SPDX-License-Identifier: MIT
// Proves, as no other test does, that sums, differences and multiples of vectors have the bits of
// Eigen's.
#include <silt/core/vectors.hpp>

#include <gtest/gtest.h>

#include <cstring>

namespace silt::test::vectors_test {
namespace {

template <class V>
class Vectors : public ::testing::Test {};
using Types = ::testing::Types<Vec<2>, Vec<3>, Vec<2, float>, Vec<3, float>>;
TYPED_TEST_SUITE(Vectors, Types);

template <class V>
void expect_same_bits(const V& a, const V& b) {
  EXPECT_EQ(std::memcmp(a.data(), b.data(), sizeof(V)), 0) << a.transpose() << " " << b.transpose();
}

TYPED_TEST(Vectors, HaveTheBitsOfEigen) {
  using V = TypeParam;
  using Real = typename V::Scalar;
  const Real odd = Real(1) / Real(3);
  for (int k = 0; k < 100; ++k) {
    V a, b;
    for (int c = 0; c < V::RowsAtCompileTime; ++c) {
      a[c] = odd * Real(k + 7 * c - 40);
      b[c] = Real(1) / Real(3 * k + c + 1);
    }
    // Arrays have operators of Eigen alone.
    expect_same_bits(V(a + b), V((a.array() + b.array()).matrix()));
    expect_same_bits(V(a - b), V((a.array() - b.array()).matrix()));
    expect_same_bits(V(-a), V((-a.array()).matrix()));
    expect_same_bits(V(a * odd), V((a.array() * odd).matrix()));
    expect_same_bits(V(odd * a), V((odd * a.array()).matrix()));
    expect_same_bits(V(a / b[0]), V((a.array() / b[0]).matrix()));
    expect_same_bits(V(2 * a), V((Real(2) * a.array()).matrix()));
    EXPECT_EQ(a == b, (a.array() == b.array()).all());
    EXPECT_TRUE(a == V(a));
  }
}

}  // namespace
}  // namespace silt::test::vectors_test
