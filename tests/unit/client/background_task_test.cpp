// SPDX-License-Identifier: Apache-2.0
#include "client/background_task.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <new>
#include <semaphore>
#include <string>
#include <vector>

#include "client/notices.hpp"

namespace tessera::client {
namespace {

TEST(BackgroundTask, RepeatsAndReportsWhatFails) {
  std::counting_semaphore<> calls(0);
  std::vector<std::string> messages;
  int count = 0;
  {
    const BackgroundTask task(
        0.001,
        [&]() -> core::Status {
          if (++count <= 3) calls.release();
          if (count == 1) return core::fail(core::ErrorCode::kUnavailable, "no room");
          if (count == 2) throw std::bad_alloc();
          return {};
        },
        [&](const std::string& message) { messages.push_back(message); });
    for (int i = 0; i < 3; ++i) calls.acquire();
  }
  EXPECT_EQ(messages, (std::vector<std::string>{"no room", "not enough memory"}));
}

TEST(BackgroundTask, EndsAtOnceWhileItWaits) {
  std::atomic<bool> called{false};
  {
    const BackgroundTask task(
        86400,
        [&]() -> core::Status {
          called = true;
          return {};
        },
        [](const std::string&) {});
  }
  EXPECT_FALSE(called);
}

TEST(Notices, TellEachMessageOnce) {
  Notices notices;
  notices.add("a");
  notices.add("b");
  EXPECT_EQ(notices.take(), (std::vector<std::string>{"a", "b"}));
  notices.add("a");
  notices.add("c");
  EXPECT_EQ(notices.take(), (std::vector<std::string>{"c"}));
}

}  // namespace
}  // namespace tessera::client
