// SPDX-License-Identifier: Apache-2.0
#include "core/view/tile_queue.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <set>
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
  for (const int tile : {2, 0, 1}) queue_.add({static_cast<Revision>(10 + tile), tile}, true, false);
  EXPECT_THAT(take_all(), ElementsAre(-2, -1, -3, 1, 0, 2));
  EXPECT_TRUE(queue_.is_empty());
}

TEST_F(TileQueueTest, SendsThoseFirstThatWereSentLongestAgo) {
  queue_.add({1, 1}, false, false);
  EXPECT_THAT(take_all(), ElementsAre(1));
  now_ += milliseconds(200);
  for (Revision revision = 2; revision < 9; ++revision) queue_.add({revision, 1}, false, false);
  queue_.add({9, 2}, false, false);
  EXPECT_THAT(take_all(), ElementsAre(2, 1));
}

TEST_F(TileQueueTest, SendsEachTileAtMostTenTimesASecond) {
  queue_.add({1, 1}, false, false);
  take_all();
  now_ += milliseconds(40);
  queue_.add({2, 1}, false, false);
  EXPECT_THAT(take_all(), ElementsAre());
  EXPECT_EQ(queue_.next_time(), now_ + milliseconds(60));
  now_ += milliseconds(60);
  EXPECT_THAT(take_all(), ElementsAre(1));
}

TEST_F(TileQueueTest, KnowsWhatIsSent) {
  queue_.add({5, 1}, false, false);
  queue_.add({7, 2}, false, false);
  EXPECT_EQ(queue_.complete_until(7), 4u);
  EXPECT_TRUE(queue_.is_next_new());
  const auto first = queue_.take(now_);
  ASSERT_TRUE(first);
  queue_.note_sent(1, 6, now_);
  EXPECT_EQ(queue_.complete_until(7), 6u);
  queue_.add({6, 1}, false, false);
  take_all();
  EXPECT_EQ(queue_.complete_until(7), 7u) << "change 6 was sent with 5";
  EXPECT_FALSE(queue_.is_next_new()) << "there is none";
  queue_.add({8, 1}, false, false);
  EXPECT_FALSE(queue_.is_next_new());
}

TEST_F(TileQueueTest, KnowsWhetherTheFirstAreSent) {
  EXPECT_TRUE(queue_.has_sent_first()) << "there are none";
  queue_.add({1, 1}, true, true);
  queue_.add({2, 2}, true, true);
  queue_.add({3, 1}, false, false);
  const auto take_fine = [&] {
    auto next = queue_.take(now_);
    while (next && next->is_coarse) next = queue_.take(now_);
    return next.value();
  };
  const TileQueue::Next first = take_fine();
  queue_.add(first.change, false, false);  // it could not be read
  EXPECT_EQ(take_fine().change.tile, first.change.tile);
  queue_.note_sent(1, 3, now_);
  queue_.add({4, 1}, false, false);
  EXPECT_FALSE(queue_.has_sent_first());
  take_fine();
  queue_.note_sent(2, 2, now_);
  EXPECT_TRUE(queue_.has_sent_first()) << "an update is none of the first";
}

TEST(StreamBudget, IsDividedAmongViewers) {
  StreamBudget budget(1000, 3000);
  auto now = StreamBudget::Clock::now();
  StreamBudget::Share one(budget, now);
  {
    StreamBudget::Share other(budget, now);
    one.note_sent(3500, true);
    EXPECT_FALSE(one.may_send(now, true)) << "the first bytes are used up";
    EXPECT_TRUE(other.may_send(now, true));
    EXPECT_FALSE(other.may_send(now, false)) << "they are not for updates";
    now += std::chrono::milliseconds(900);
    EXPECT_TRUE(one.may_send(now, false));
    one.note_sent(950, false);
    now += std::chrono::milliseconds(900);
    EXPECT_FALSE(one.may_send(now, false)) << "500 bytes take a second at half the rate";
    now += std::chrono::milliseconds(200);
    EXPECT_TRUE(one.may_send(now, false));
  }
  EXPECT_EQ(budget.viewers(), 1);
  one.note_sent(1050, false);
  EXPECT_FALSE(one.may_send(now, false));
  EXPECT_GT(one.next_time(false), now + std::chrono::milliseconds(900));
}

TEST(StreamBudget, LetsViewersLookTogether) {
  StreamBudget budget;
  std::vector<std::unique_ptr<StreamBudget::Share>> shares;
  const auto start = StreamBudget::Clock::now();
  for (int i = 0; i < 200; ++i) shares.push_back(std::make_unique<StreamBudget::Share>(budget, start));
  std::set<StreamBudget::Clock::time_point> wakes;
  for (int i = 0; i < 200; ++i) {
    const auto due = start + i * budget.poll_interval() / 200;
    const auto wake = budget.joint_time(due);
    EXPECT_GE(wake, due);
    EXPECT_LE(wake - due, StreamBudget::Clock::duration(budget.poll_interval()) / 8);
    wakes.insert(wake);
  }
  EXPECT_LE(wakes.size(), 10u);
}

}  // namespace
}  // namespace tessera::view
