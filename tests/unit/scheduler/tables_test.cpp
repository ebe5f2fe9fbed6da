// SPDX-License-Identifier: Apache-2.0
// Tables that take no memory before they are used, and none for what is stale.
#include <gtest/gtest.h>

#include <string>

#include "server/scheduler/swept_map.hpp"
#include "server/scheduler/tile_table.hpp"

namespace tessera::scheduler {
namespace {

TEST(TileTable, HasDefaultsWhereNothingWasWritten) {
  TileTable<std::string> table(1000);
  EXPECT_EQ(table.tile_count(), 1000);
  EXPECT_EQ(table.next_written(0), 1000);
  table.mutable_at(600) = "written";
  EXPECT_EQ(table[600], "written");
  EXPECT_EQ(table[599], "");
  EXPECT_EQ(table[999], "");
  TileTable<std::string> moved = std::move(table);
  EXPECT_EQ(moved[600], "written");
}

TEST(TileTable, SkipsOnlyTilesThatWereNeverWritten) {
  TileTable<int> table(2000);
  for (const int tile : {0, 700, 1999}) table.mutable_at(tile) = 1;
  int found = 0, visited = 0;
  for (int tile = table.next_written(0); tile < table.tile_count(); tile = table.next_written(tile + 1)) {
    found += table[tile];
    ++visited;
  }
  EXPECT_EQ(found, 3);
  EXPECT_LT(visited, 800);
}

TEST(SweptMap, KeepsWhatIsInUseAndLittleElse) {
  SweptMap<int, int> map;
  int first_in_use = 0;
  const auto in_use = [&](int key, int) { return key >= first_in_use; };
  for (int key = 0; key < 10'000; ++key) {
    first_in_use = std::max(0, key - 100);
    map.at_or_insert(key, in_use) = key;
    ASSERT_LE(map.size(), 400u) << key;
    for (int used = first_in_use; used <= key; ++used) {
      ASSERT_NE(map.find(used), nullptr) << used;
      ASSERT_EQ(*map.find(used), used);
    }
  }
}

TEST(SweptMap, LooksAtNothingWhenAnEntryExists) {
  SweptMap<int, int> map;
  map.at_or_insert(1, [](int, int) { return true; }) = 5;
  map.at_or_insert(2, [](int, int) { return true; });
  EXPECT_EQ(map.at_or_insert(1, [](int, int) { return false; }), 5);
  EXPECT_EQ(map.size(), 2u);
  map.erase(1);
  EXPECT_EQ(map.find(1), nullptr);
}

}  // namespace
}  // namespace tessera::scheduler
