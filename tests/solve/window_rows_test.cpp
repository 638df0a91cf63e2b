// SPDX-License-Identifier: MIT
#include "support/check.hpp"

#include <silt/linear/window_rows.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <random>
#include <utility>
#include <vector>

namespace silt::test::window_rows_test {
namespace {

using Entries = std::map<std::pair<Index, Index>, double>;

// A few entries per row, in clusters, with values that are exact in single precision.
Entries clustered(Index n) {
  std::mt19937 random(8);
  Entries entries;
  for (Index row = 0; row < n; ++row) {
    for (int cluster = 0; cluster < 3; ++cluster) {
      const Index at = random() % n;
      for (Index k = 0; k < 1 + random() % 12; ++k) {
        entries[{row, std::min(n - 1, at + k)}] = double(random() % 1000) / 64 - 5;
      }
    }
  }
  return entries;
}

WindowRows rows_of(Index n, const Entries& entries, bool backwards = false) {
  WindowRows rows;
  rows.build(n, [&](Index i, auto&& add) {
    std::vector<std::pair<Index, double>> row;
    for (auto at = entries.lower_bound({i, 0}); at != entries.end() && at->first.first == i; ++at) {
      row.emplace_back(at->first.second, at->second);
    }
    if (backwards) std::reverse(row.begin(), row.end());
    for (const auto& [column, value] : row) add(column, value);
  });
  return rows;
}

std::vector<double> product(const WindowRows& rows, const std::vector<double>& x) {
  std::vector<double> all(rows.size());
  for_each_range<rows_together>(rows.size(), [&](Index first, Index last) {
    rows.multiply(first, last, x, [&](Index i, double sum) { all[i] = sum; });
  });
  return all;
}

TEST(WindowRows, KeepTheirEntriesForAnyOrderOfInsertion) {
  for (const Index n : {1u, 5u, 8u, 9u, 100u, 3000u}) {
    Entries entries = clustered(n);
    for (const bool backwards : {false, true}) {
      const WindowRows rows = rows_of(n, entries, backwards);
      EXPECT_EQ(rows.size(), n);
      Entries found;
      for (Index row = 0; row < n; ++row) {
        rows.for_each_entry(row,
                            [&](Index column, double value) { found[{row, column}] += value; });
      }
      std::erase_if(entries, [](const auto& each) { return each.second == 0; });
      EXPECT_EQ(found, entries) << n;
    }
  }
}

TEST(WindowRows, GiveTheProductOfTheirEntries) {
  for (const Index n : {1u, 3u, 4u, 7u, 100u, 3000u}) {
    const Entries entries = clustered(n);
    const WindowRows rows = rows_of(n, entries);
    std::vector<double> x(n);
    for (Index i = 0; i < n; ++i) x[i] = double(i % 17) - 3;  // integers: no rounding
    std::vector<double> expected(n, 0);
    for (const auto& [place, value] : entries) expected[place.first] += value * x[place.second];
    EXPECT_EQ(product(rows, x), expected) << n;
  }
}

// That rows have any extent, with columns that differ by more than 16 bits can hold, and any number of
// entries, which the rows of a fluid do not have.
TEST(WindowRows, MayBeWideAndLong) {
  constexpr Index columns = 200000;
  const auto for_each_entry_of = [](Index i, auto&& add) {
    add(i, 1.0);
    if (i >= 256) add(columns - 1 - i, 2.0);  // not in the first rows that are stored together
    for (Index k = 0; i % 3 == 0 && k < i; ++k) add(1000 + 3 * k, 0.5);
  };
  WindowRows rows;
  rows.build(700, columns, for_each_entry_of);
  std::vector<double> x(columns);
  for (Index i = 0; i < columns; ++i) x[i] = double(i % 17) - 3;
  std::vector<double> expected(rows.size(), 0);
  for (Index i = 0; i < rows.size(); ++i) {
    std::map<Index, double> entries, found;
    for_each_entry_of(i, [&](Index column, double value) { entries[column] += value; });
    for (const auto& [column, value] : entries) expected[i] += value * x[column];
    rows.for_each_entry(i, [&](Index column, double value) { found[column] += value; });
    EXPECT_EQ(found, entries) << i;
  }
  EXPECT_EQ(product(rows, x), expected);
}

TEST(WindowRows, SumRepeatedEntries) {
  WindowRows rows;
  rows.build(20, [](Index i, auto&& add) {
    add(i, 1.5);
    add(i, 2.0);
  });
  rows.for_each_entry(7, [](Index column, double value) {
    EXPECT_EQ(column, 7u);
    EXPECT_EQ(value, 3.5);
  });
  EXPECT_EQ(product(rows, std::vector<double>(20, 2)), std::vector<double>(20, 7));
}

TEST(WindowRows, FindEntriesInMarkedColumns) {
  for (const Index n : {5u, 60u}) {
    const Entries entries = clustered(n);
    const WindowRows rows = rows_of(n, entries);
    for (Index column = 0; column < n; ++column) {
      std::vector<std::uint8_t> marked(n, 0);
      marked[column] = 1;
      for (Index row = 0; row < n; ++row) {
        const auto entry = entries.find({row, column});
        EXPECT_EQ(rows.has_entry_in(row, marked), entry != entries.end() && entry->second != 0);
      }
    }
  }
}

TEST(WindowRows, ContainNothingOfAnEarlierBuild) {
  WindowRows rows = rows_of(3000, clustered(3000));
  rows.build(10, [](Index, auto&&) {});
  EXPECT_EQ(rows.size(), 10u);
  for (Index row = 0; row < 10; ++row) {
    rows.for_each_entry(row, [](Index, double) { ADD_FAILURE(); });
  }
  EXPECT_EQ(product(rows, std::vector<double>(10, 1)), std::vector<double>(10, 0));
}

}  // namespace
}  // namespace silt::test::window_rows_test
