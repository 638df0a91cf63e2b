// SPDX-License-Identifier: MIT
#include "support/check.hpp"

#include <silt/dem/contact/pair_history.hpp>

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace silt::test::pair_history_test {
namespace {

using History = PairHistory<double>;

History filled() {
  return History({{2, wall_id(0), 13}, {1, 5, 11}, {5, wall_id(0), 14}, {1, 2, 10}, {2, 5, 12}});
}

TEST(PairHistory, FindsAPairInEitherOrder) {
  const History history = filled();
  ASSERT_NE(history.find(1, 5), nullptr);
  EXPECT_EQ(*history.find(1, 5), 11);
  EXPECT_EQ(history.find(5, 1), history.find(1, 5));
  EXPECT_EQ(*history.find(2, wall_id(0)), 13);
  EXPECT_EQ(history.find(1, wall_id(0)), nullptr);
  EXPECT_EQ(history.find(7, 8), nullptr);
  EXPECT_EQ(History{}.find(0, 1), nullptr);
}

TEST(PairHistory, IteratesInTheOrderOfIds) {
  std::vector<std::pair<Id, Id>> pairs;
  std::vector<double> values;
  filled().for_each_pair([&](Id a, Id b, double value) {
    pairs.emplace_back(a, b);
    values.push_back(value);
  });
  EXPECT_EQ(pairs, (std::vector<std::pair<Id, Id>>{
                       {1, 2}, {1, 5}, {2, 5}, {2, wall_id(0)}, {5, wall_id(0)}}));
  EXPECT_EQ(values, (std::vector<double>{10, 11, 12, 13, 14}));
  EXPECT_EQ(filled().size(), 5u);
}

TEST(PairHistory, RejectsInvalidPairs) {
  EXPECT_TRUE(refuses([] { History({{5, 2, 0.0}}); }, {"PairHistory", "5, 2", "lower id"}));
  EXPECT_TRUE(refuses([] { History({{2, 2, 0.0}}); }, {"PairHistory", "2, 2", "lower id"}));
  EXPECT_TRUE(refuses([] { History({{1, 2, 0.0}, {0, 1, 0.0}, {1, 2, 1.0}}); },
                      {"PairHistory", "1, 2", "twice"}));
}

}  // namespace
}  // namespace silt::test::pair_history_test
