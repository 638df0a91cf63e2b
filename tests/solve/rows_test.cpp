// SPDX-License-Identifier: MIT
#include <silt/linear/rows.hpp>

#include "support/check.hpp"
#include <gtest/gtest.h>

namespace silt::test::rows_test {
namespace {

TEST(Rows, AreTheSameForAnyNumberOfThreads) {
  for (const int number : {1, 2, 3, 4}) {
    with_threads(number, [] {
      Rows<Index> rows;
      for (const Index n : {Index{4000}, Index{0}, Index{1}, Index{3000}}) {  // memory is reused
        rows.build(n, [](Index i, auto&& add) {
          for (Index k = 0; k < i % 4; ++k) add(10 * i + k);
        });
        ASSERT_EQ(rows.size(), n);
        for (Index i = 0; i < n; ++i) {
          ASSERT_EQ(rows[i].size(), i % 4);
          for (Index k = 0; k < i % 4; ++k) ASSERT_EQ(rows[i][k], 10 * i + k);
        }
      }
    });
  }
}

TEST(Rows, AreNoneBeforeTheFirstBuild) { EXPECT_EQ(Rows<int>{}.size(), 0u); }

}  // namespace
}  // namespace silt::test::rows_test
