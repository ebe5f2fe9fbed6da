// SPDX-License-Identifier: Apache-2.0
// On which thread tasks run.
#include "server/base/thread_pool.hpp"

#include <gtest/gtest.h>

#include <latch>

namespace tessera::server {
namespace {

using ThreadId = std::thread::id;

TEST(ThreadPool, RunsAShortTaskAtItsCallerWhileNothingElseIsToBeDone) {
  base::ThreadPool pool(1, 8);
  for (int i = 0; i < 2; ++i) {
    ThreadId ran_on;
    ASSERT_TRUE(pool.run_or_post([&] { ran_on = std::this_thread::get_id(); }));
    EXPECT_EQ(ran_on, std::this_thread::get_id());
  }
}

TEST(ThreadPool, KeepsOneCallerAtATime) {
  ThreadId ran_on;
  {
    base::ThreadPool pool(1, 8);
    ASSERT_TRUE(pool.run_or_post(
        [&] { ASSERT_TRUE(pool.run_or_post([&] { ran_on = std::this_thread::get_id(); })); }));
  }
  EXPECT_NE(ran_on, ThreadId());
  EXPECT_NE(ran_on, std::this_thread::get_id());
}

TEST(ThreadPool, LetsNoShortTaskOvertakeWhatWaits) {
  std::latch busy(1), released(1);
  std::vector<int> order;
  {
    base::ThreadPool pool(1, 2);
    ASSERT_TRUE(pool.post([&] {
      busy.count_down();
      released.wait();
    }));
    busy.wait();
    ASSERT_TRUE(pool.post([&] { order.push_back(1); }));
    ASSERT_TRUE(pool.run_or_post([&] { order.push_back(2); }));
    EXPECT_FALSE(pool.run_or_post([] {})) << "two wait already";
    released.count_down();
  }
  EXPECT_EQ(order, (std::vector{1, 2}));
}

}  // namespace
}  // namespace tessera::server
