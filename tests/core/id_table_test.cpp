// SPDX-License-Identifier: MIT
#include <silt/core/error.hpp>
#include <silt/core/id_table.hpp>

#include <gtest/gtest.h>

#include <vector>

namespace silt::test::id_table_test {
namespace {

// Particles are added, and all are removed but those whose id is a multiple of `kept`.
void expect_ids_found(Id kept, Id first) {
  std::vector<Id> ids;
  detail::IdTable table({}, first);
  Id next = first;
  for (int round = 0; round < 20; ++round) {
    for (int k = 0; k < 100; ++k) {
      table.make_room(ids.size() + 1, next + 1, ids);
      ids.push_back(next++);
      EXPECT_TRUE(table.add(ids.size() - 1, ids));
    }
    std::erase_if(ids, [&](Id id) { return id % kept != 0; });
    table.assign(ids);
    for (Index i = 0; i < ids.size(); ++i) ASSERT_EQ(table.find(ids[i], ids), i);
    Index found = 0;
    for (Id id = first; id < next; ++id) found += table.find(id, ids) != no_index;
    ASSERT_EQ(found, ids.size()) << "round " << round;
  }
}

TEST(IdTable, FindsThePresentIdsOnly) {
  for (const Id kept : {1, 2, 10, 64, 3000}) {
    expect_ids_found(kept, 0);
    expect_ids_found(kept, Id(1) << 60);
  }
}

TEST(IdTable, RefusesIdsThatCannotBe) {
  EXPECT_THROW(detail::IdTable(std::vector<Id>{1, 2, 1}, 3), Error);
  EXPECT_THROW(detail::IdTable(std::vector<Id>{1, 3}, 3), Error);
  EXPECT_THROW(detail::IdTable({}, ~Id(0)), Error);
  EXPECT_NO_THROW(detail::IdTable(std::vector<Id>{7, 2, 1}, Id(1) << 63));
}

}  // namespace
}  // namespace silt::test::id_table_test
