// SPDX-License-Identifier: MIT
#include "support/check.hpp"

#include <silt/core/pair_memory.hpp>

#include <gtest/gtest.h>

#include <map>
#include <utility>
#include <vector>

namespace silt::test {
namespace {

using Memory = PairMemory<double>;
using Table = std::vector<std::pair<Id, std::vector<Id>>>;  // rows: owner, partners

void renew(Memory& memory, const Table& rows) {
  std::vector<Id> owners;
  std::vector<Index> first{0};
  std::vector<Id> partners;
  for (const auto& [owner, row] : rows) {
    owners.push_back(owner);
    partners.insert(partners.end(), row.begin(), row.end());
    first.push_back(partners.size());
  }
  memory.renew(owners, first, partners);
}

std::map<std::pair<Id, Id>, double> contents(const Memory& memory) {
  std::map<std::pair<Id, Id>, double> all;
  memory.for_each_pair([&](Id a, Id b, double value) {
    EXPECT_TRUE((all.emplace(std::pair(a, b), value).second)) << "a pair is given once";
  });
  EXPECT_EQ(all.size(), memory.size());
  return all;
}

Memory filled() {
  Memory memory;
  renew(memory, {{1, {2, 5}}, {2, {5, wall_id(0)}}, {5, {wall_id(0)}}});
  double value = 10;
  for (double& each : memory.values()) each = value++;
  return memory;
}

TEST(PairMemory, StartsNewPairsFromNothing) {
  Memory memory;
  renew(memory, {{1, {2, 5}}});
  for (const double value : memory.values()) EXPECT_EQ(value, 0);
}

TEST(PairMemory, FindsAPairInEitherOrder) {
  const Memory memory = filled();
  ASSERT_NE(memory.find(1, 5), nullptr);
  EXPECT_EQ(*memory.find(1, 5), 11);
  EXPECT_EQ(memory.find(5, 1), memory.find(1, 5));
  EXPECT_EQ(*memory.find(2, wall_id(0)), 13);
  EXPECT_EQ(memory.find(1, wall_id(0)), nullptr);
  EXPECT_EQ(memory.find(7, 8), nullptr);
  EXPECT_EQ(Memory{}.find(0, 1), nullptr);
}

TEST(PairMemory, KeepsValuesWhenRowsChangePlaces) {
  Memory memory = filled();
  const auto before = contents(memory);
  renew(memory, {{5, {wall_id(0)}}, {1, {2, 5}}, {2, {5, wall_id(0)}}});
  EXPECT_EQ(contents(memory), before);
}

TEST(PairMemory, ForgetsPairsThatPartedAndKeepsTheOthers) {
  Memory memory = filled();
  renew(memory, {{1, {5}}, {2, {5}}, {5, {9, wall_id(0)}}});
  EXPECT_EQ(contents(memory),
            (std::map<std::pair<Id, Id>, double>{
                {{1, 5}, 11}, {{2, 5}, 12}, {{5, 9}, 0}, {{5, wall_id(0)}, 14}}));
  renew(memory, {{1, {2, 5}}});
  EXPECT_EQ(*memory.find(1, 2), 0) << "a pair that meets again starts anew";
}

TEST(PairMemory, ForgetsARemovedParticle) {
  Memory memory = filled();
  renew(memory, {{1, {2}}, {2, {wall_id(0)}}});
  EXPECT_EQ(contents(memory),
            (std::map<std::pair<Id, Id>, double>{{{1, 2}, 10}, {{2, wall_id(0)}, 13}}));
}

TEST(PairMemory, IsRestoredAfterARenewalThatFailed) {
  Memory memory = filled();
  const auto before = contents(memory);
  memory.save();
  renew(memory, {{1, {2}}, {3, {4}}});
  for (double& each : memory.values()) each = -1;
  memory.restore();
  EXPECT_EQ(contents(memory), before);
  memory.restore();
  EXPECT_EQ(contents(memory), before) << "there is nothing more to undo";
}

TEST(PairMemory, IsRestoredAfterSeveralRenewalsInOneStep) {
  Memory memory = filled();
  const auto before = contents(memory);
  memory.save();
  for (int stage = 0; stage < 4; ++stage) {
    renew(memory, {{1, {2, 5}}, {3, {4}}});
    for (double& each : memory.values()) each += 100;
  }
  EXPECT_EQ(*memory.find(1, 2), 410) << "a value grows through all stages";
  memory.restore();
  EXPECT_EQ(contents(memory), before);
}

TEST(PairMemory, IsNotChangedByAStepThatFailsBeforeItsRenewal) {
  Memory memory = filled();
  const auto before = contents(memory);
  memory.save();
  memory.restore();
  EXPECT_EQ(contents(memory), before);
}

TEST(PairMemory, GoesThroughACheckpointWhateverTheOrderOfItsEntries) {
  const Memory memory = filled();
  std::vector<Memory::Entry> entries;
  memory.for_each_pair([&](Id a, Id b, double value) { entries.insert(entries.begin(), {a, b, value}); });
  Memory restarted;
  restarted.assign(entries);
  EXPECT_EQ(contents(restarted), contents(memory));
  renew(restarted, {{1, {2}}});
  EXPECT_EQ(*restarted.find(1, 2), 10);
  restarted.assign({});
  EXPECT_EQ(restarted.size(), 0u);
}

TEST(PairMemory, RefusesEntriesThatCannotBePairs) {
  Memory memory;
  EXPECT_TRUE(refuses([&] { memory.assign({{5, 2, 0.0}}); }, {"PairMemory::assign", "5, 2"}));
  EXPECT_TRUE(refuses([&] { memory.assign({{2, 2, 0.0}}); }, {"PairMemory::assign", "2, 2"}));
  EXPECT_TRUE(refuses([&] { memory.assign({{1, 2, 0.0}, {0, 1, 0.0}, {1, 2, 1.0}}); },
                      {"PairMemory::assign", "1, 2", "twice"}));
}

}  // namespace
}  // namespace silt::test
