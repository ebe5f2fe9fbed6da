// SPDX-License-Identifier: Apache-2.0
#include "core/view/tile_queue.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "core/view/stream_budget.hpp"

namespace tessera::view {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;

class TileQueueTest : public testing::Test {
 protected:
  // 3 x 1 tiles; the viewer looks at the second one.
  TileQueue queue_{core::TileGrid(192, 64, 64), 90, 32};
  TileQueue::Clock::time_point now_ = TileQueue::Clock::time_point{} + std::chrono::hours(1);

  // Takes and sends all that there is now; coarse tiles as -1 - tile.
  std::vector<int> take_all() {
    std::vector<int> tiles;
    while (const auto next = queue_.take(now_)) {
      tiles.push_back(next->is_coarse ? -1 - next->change.tile : next->change.tile);
      if (!next->is_coarse) queue_.note_sent(next->change.tile, next->change.revision, now_);
    }
    return tiles;
  }
};

TEST_F(TileQueueTest, GoesFromTheCentreOutwardCoarselyFirst) {
  for (const int tile : {2, 0, 1}) queue_.add({static_cast<Revision>(10 + tile), tile}, true);
  EXPECT_THAT(take_all(), ElementsAre(-2, -1, -3, 1, 0, 2));
  EXPECT_TRUE(queue_.is_empty());
}

TEST_F(TileQueueTest, SendsThoseFirstThatWereSentLongestAgo) {
  queue_.add({1, 1}, false);
  EXPECT_THAT(take_all(), ElementsAre(1));
  now_ += milliseconds(200);
  for (Revision revision = 2; revision < 9; ++revision) queue_.add({revision, 1}, false);
  queue_.add({9, 2}, false);
  EXPECT_THAT(take_all(), ElementsAre(2, 1));
}

TEST_F(TileQueueTest, SendsEachTileAtMostTenTimesASecond) {
  queue_.add({1, 1}, false);
  take_all();
  now_ += milliseconds(40);
  queue_.add({2, 1}, false);
  EXPECT_THAT(take_all(), ElementsAre());
  EXPECT_EQ(queue_.next_time(), now_ + milliseconds(60));
  now_ += milliseconds(60);
  EXPECT_THAT(take_all(), ElementsAre(1));
}

TEST_F(TileQueueTest, KnowsWhatIsSent) {
  queue_.add({5, 1}, false);
  queue_.add({7, 2}, false);
  EXPECT_EQ(queue_.complete_until(7), 4u);
  const auto first = queue_.take(now_);
  ASSERT_TRUE(first);
  queue_.note_sent(1, 6, now_);
  EXPECT_EQ(queue_.complete_until(7), 6u);
  queue_.add({6, 1}, false);
  take_all();
  EXPECT_EQ(queue_.complete_until(7), 7u) << "change 6 was sent with 5";
}

TEST(StreamBudget, IsDividedAmongViewers) {
  StreamBudget budget(1000, 3000);
  auto now = StreamBudget::Clock::now();
  StreamBudget::Share one(budget, now);
  {
    StreamBudget::Share other(budget, now);
    one.note_sent(3500);
    EXPECT_FALSE(one.may_send(now));
    EXPECT_TRUE(other.may_send(now));
    now += std::chrono::milliseconds(900);
    EXPECT_FALSE(one.may_send(now)) << "500 bytes take a second at half the rate";
    now += std::chrono::milliseconds(200);
    EXPECT_TRUE(one.may_send(now));
  }
  EXPECT_EQ(budget.viewers(), 1);
  one.note_sent(1050);
  EXPECT_FALSE(one.may_send(now));
  EXPECT_GT(one.next_time(), now + std::chrono::milliseconds(900));
}

}  // namespace
}  // namespace tessera::view
