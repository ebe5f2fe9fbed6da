// SPDX-License-Identifier: Apache-2.0
#include "server/auth/call_rate.hpp"

#include <gtest/gtest.h>

#include "server/limits.hpp"

namespace tessera::rpc {
namespace {

using namespace std::chrono_literals;

class CallRateTest : public testing::Test {
 protected:
  // The number of calls in a row that are admitted.
  int burst(const std::string& caller) {
    int calls = 0;
    while (!rate_.take(caller)) ++calls;
    return calls;
  }

  auth::CallRate::Clock::time_point now_{1h};
  auth::CallRate rate_{2, [this] { return now_; }};
};

TEST_F(CallRateTest, AnIdleCallerMayBurst) {
  EXPECT_EQ(burst("a"), 2 * server::kBurstSeconds);
}

TEST_F(CallRateTest, ThenSoOftenASecond) {
  burst("a");
  now_ += 3s;
  EXPECT_EQ(burst("a"), 6);
  now_ += 1h;
  EXPECT_EQ(burst("a"), 2 * server::kBurstSeconds) << "nobody saves up more";
}

TEST_F(CallRateTest, SaysWhenToTryAgain) {
  burst("a");
  const auto wait = rate_.take("a");
  ASSERT_TRUE(wait);
  EXPECT_EQ(*wait, 500ms);
  now_ += *wait - 1ms;
  EXPECT_TRUE(rate_.take("a"));
  now_ += 1ms;
  EXPECT_FALSE(rate_.take("a"));
}

TEST_F(CallRateTest, CallersDoNotCountForEachOther) {
  burst("a");
  EXPECT_EQ(burst("b"), 2 * server::kBurstSeconds);
}

TEST_F(CallRateTest, ForgetsManyCallersExceptThrottledOnes) {
  burst("a");
  for (int i = 0; i < 100'000; ++i) {
    now_ += 1ms;
    EXPECT_FALSE(rate_.take("caller " + std::to_string(i)));
    if (i % 100 == 0) {
      EXPECT_LE(burst("a"), 1);
    }
  }
}

}  // namespace
}  // namespace tessera::rpc
