// SPDX-License-Identifier: Apache-2.0
// Quotas that callers share, and the fair thread pool.
#include "server/base/fair_share.hpp"

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <string>
#include <vector>

#include "server/base/fair_pool.hpp"

namespace tessera::server {
namespace {

using Taken = std::vector<base::FairShare::Held>;

// How often the caller can take this amount.
int take_all(base::FairShare& share, const std::string& caller, Taken& taken, std::uint64_t amount = 1) {
  for (int times = 0;; ++times) {
    auto held = share.take(caller, amount);
    if (!held) return times;
    taken.push_back(*std::move(held));
  }
}

TEST(FairShare, OneCallerAloneHasHalf) {
  base::FairShare share(64);
  Taken taken;
  EXPECT_EQ(take_all(share, "a", taken), 32);
  EXPECT_EQ(share.held_by("a"), 32u);
}

TEST(FairShare, AShareIsReservedForNewClients) {
  base::FairShare share(64);
  Taken taken;
  for (int caller = 0; caller < 6; ++caller) {
    EXPECT_GE(take_all(share, std::to_string(caller), taken), 1) << caller;
  }
  EXPECT_LE(share.held(), 64u);
}

TEST(FairShare, WhatIsGivenBackCanBeTakenAgain) {
  base::FairShare share(8);
  Taken taken;
  EXPECT_EQ(take_all(share, "a", taken), 4);
  taken.clear();
  EXPECT_EQ(share.held(), 0u);
  EXPECT_EQ(share.held_by("a"), 0u);
  EXPECT_EQ(take_all(share, "b", taken), 4);
}

TEST(FairShare, ASingleClientGetsAnyAmountOnce) {
  base::FairShare share(10);
  const auto large = share.take("a", 25);
  EXPECT_TRUE(large);
  EXPECT_FALSE(share.take("a"));
  EXPECT_FALSE(share.take("b"));
}

TEST(FairShare, AmountsCount) {
  base::FairShare share(10);
  Taken taken;
  EXPECT_EQ(take_all(share, "a", taken, 3), 2);
  EXPECT_EQ(take_all(share, "b", taken, 3), 1);
  EXPECT_EQ(take_all(share, "c", taken, 3), 0);
  EXPECT_EQ(take_all(share, "c", taken, 1), 1);
  EXPECT_EQ(share.held(), 10u);
}

// A pool of one thread, which a first task blocks until it is released.
class FairPoolTest : public testing::Test {
 protected:
  FairPoolTest() {
    EXPECT_TRUE(pool_.post("gate", [this] {
      std::unique_lock lock(mutex_);
      held_up_ = true;
      changed_.notify_all();
      changed_.wait(lock, [this] { return released_; });
    }));
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return held_up_; });
  }
  ~FairPoolTest() override { release(); }

  bool post(const std::string& caller, const std::string& name) {
    return pool_.post(caller, [this, name] {
      const std::lock_guard lock(mutex_);
      done_.push_back(name);
      changed_.notify_all();
    });
  }
  void release() {
    const std::lock_guard lock(mutex_);
    released_ = true;
    changed_.notify_all();
  }
  std::vector<std::string> wait_for(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return done_.size() == count; });
    return done_;
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  bool held_up_ = false, released_ = false;
  std::vector<std::string> done_;
  base::FairPool pool_{1, 8};  // destroyed first
};

TEST_F(FairPoolTest, CallersTakeTurns) {
  for (const char* name : {"a1", "a2", "a3", "a4"}) EXPECT_TRUE(post("a", name));
  for (const char* name : {"b1", "b2"}) EXPECT_TRUE(post("b", name));
  EXPECT_TRUE(post("c", "c1"));
  release();
  EXPECT_EQ(wait_for(7), (std::vector<std::string>{"a1", "b1", "c1", "a2", "b2", "a3", "a4"}));
}

TEST_F(FairPoolTest, NoClientFillsTheQueue) {
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(post("a", "a"));
  EXPECT_FALSE(post("a", "a"));
  EXPECT_EQ(pool_.waiting_of("a"), 4u);
  EXPECT_TRUE(post("b", "b"));
  release();
  wait_for(5);
  EXPECT_EQ(pool_.waiting_of("a"), 0u);
  EXPECT_TRUE(post("a", "a"));
  wait_for(6);
}

TEST_F(FairPoolTest, RunsQueuedTasksAndReportsTimeouts) {
  EXPECT_TRUE(post("a", "a"));
  EXPECT_FALSE(pool_.is_closed());
  pool_.close();
  EXPECT_TRUE(pool_.is_closed());
  release();
  wait_for(1);
}

}  // namespace
}  // namespace tessera::server
