// SPDX-License-Identifier: Apache-2.0
// The ledger of producers, and the comparison of sums.
#include "tests/unit/scheduler/farm.hpp"

namespace tessera::scheduler {
namespace {

TEST(AuditChoice, IsOfTheShareThatWasAskedForAndFollowsFromItsSecret) {
  int chosen = 0, differ = 0;
  for (int tile = 0; tile < 1000; ++tile) {
    for (std::uint32_t s = 0; s < 10; ++s) {
      const WorkItem item{tile, {s, s + 1}};
      const bool is_chosen = chosen_for_audit(0.1, 1, {"job"}, item);
      chosen += is_chosen;
      differ += is_chosen != chosen_for_audit(0.1, 2, {"job"}, item);
      EXPECT_EQ(is_chosen, chosen_for_audit(0.1, 1, {"job"}, item));
      EXPECT_TRUE(chosen_for_audit(1, 1, {"job"}, item));
      EXPECT_FALSE(chosen_for_audit(0, 1, {"job"}, item));
    }
  }
  EXPECT_NEAR(chosen, 1000, 150);
  EXPECT_NEAR(differ, 1800, 250);
}

TEST(FingerprintTest, CannotTellOnlyWhereBothMayBeCutOff) {
  constexpr float kCutOff = std::numeric_limits<float>::infinity();
  EXPECT_TRUE(same_sums({1, 2, 3}, {1, 2, 3}));
  EXPECT_FALSE(same_sums({1, 2, 3}, {1, 3, 3}));
  EXPECT_FALSE(same_sums({1, 2, kCutOff}, {1, 3, 3}));
  EXPECT_FALSE(same_sums({1, 2, 0x1p63F}, {1, 3, 0x1p63F}));
  EXPECT_TRUE(same_sums({1, 2, kCutOff}, {1, 3, 0x1p63F}));
  EXPECT_TRUE(same_sums({1, 2, kCutOff}, {1, 3, kCutOff}));
}

TEST(LedgerTest, NeighboursOfOneAuthorBecomeOneEntryUpToALength) {
  Ledger ledger(tiles(2, 1000).grid());
  for (std::uint32_t s = 0; s < 100; ++s) ledger.add({0, {s, s + 1}}, 5, sums(s), Due::kNo);
  ASSERT_EQ(ledger.of_tile(0).size(), 2u);
  EXPECT_EQ(ledger.of_tile(0)[0].samples, (core::SampleRange{0, 64}));
  EXPECT_EQ(ledger.of_tile(0)[0].low, 63u * 64 / 2);
  ledger.add({0, {100, 101}}, 6, sums(1), Due::kNo);
  ledger.add({0, {101, 102}}, 6, sums(1), Due::kChosen);
  EXPECT_EQ(ledger.of_tile(0).size(), 4u);
  EXPECT_EQ(ledger.due(), kTilePixels);
}

TEST(LedgerTest, IsBoundedButForWhatIsDue) {
  const JobShape large{16384, 16384, 64};
  Ledger ledger(large.grid());
  const auto add = [&](std::uint32_t s, Due due) {
    for (int tile = 0; tile < large.grid().tile_count(); ++tile)
      ledger.add({tile, {2 * s, 2 * s + 1}}, 1, sums(1), due);
  };
  const auto count = [&] {
    std::size_t entries = 0;
    for (int tile = 0; tile < ledger.tile_count(); ++tile) entries += ledger.of_tile(tile).size();
    return entries;
  };
  for (std::uint32_t s = 0; s < 25; ++s) add(s, Due::kNo);
  EXPECT_EQ(count(), Ledger::kMaxEntries);
  ledger.add({0, {63, 64}}, 1, sums(1), Due::kDoubted);
  EXPECT_EQ(count(), Ledger::kMaxEntries + 1);
}

}  // namespace
}  // namespace tessera::scheduler
