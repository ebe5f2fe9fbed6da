// SPDX-License-Identifier: Apache-2.0
#include "proto/retry.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace tessera::proto {
namespace {

using core::ErrorCode;
using namespace std::chrono_literals;

// A clock that advances only by waiting.
struct FakeTime {
  Duration now{};
  std::vector<Duration> waits;
  bool interrupted = false;

  Waiter waiter() {
    return {[this] { return now; },
            [this](Duration wait) {
              waits.push_back(wait);
              now += wait;
              return !interrupted;
            }};
  }
};

constexpr BackoffOptions kNoJitter{.first = 100ms, .longest = 1s, .growth = 2, .jitter = 0};

core::Status failure(ErrorCode code) {
  return core::fail(code, "no");
}

TEST(Retry, WaitsLongerEachTimeUpToTheLongest) {
  FakeTime time;
  int attempts = 0;
  const auto status = retry(exponential_backoff(kNoJitter), time.waiter(), [&]() -> core::Status {
    return ++attempts < 7 ? failure(ErrorCode::kUnavailable) : core::Status{};
  });
  EXPECT_TRUE(status.has_value());
  EXPECT_EQ(time.waits, (std::vector<Duration>{100ms, 200ms, 400ms, 800ms, 1s, 1s}));
}

TEST(Retry, JitterShortensAndNeverLengthens) {
  BackoffOptions options = kNoJitter;
  options.jitter = 0.5;
  const RetryPolicy policy = exponential_backoff(options, 1);
  Duration shortest = 1s, longest{};
  for (int i = 0; i < 1000; ++i) {
    const Duration wait = policy({.count = 3}).value();
    shortest = std::min(shortest, wait);
    longest = std::max(longest, wait);
  }
  EXPECT_GE(shortest, 200ms);
  EXPECT_LT(shortest, 210ms);
  EXPECT_LE(longest, 400ms);
  EXPECT_GT(longest, 390ms);
}

TEST(Retry, ManyAttemptsStayAtTheLongestWait) {
  EXPECT_EQ(exponential_backoff(kNoJitter)({.count = 1'000'000'000}).value(), 1s);
}

TEST(Retry, ErrorsThatRepeatAreNotRetried) {
  FakeTime time;
  int attempts = 0;
  const auto status = retry(transient_only(exponential_backoff(kNoJitter)), time.waiter(), [&] {
    return ++attempts == 1 ? failure(ErrorCode::kDeadlineExceeded) : failure(ErrorCode::kInvalidArgument);
  });
  EXPECT_EQ(status.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(attempts, 2);
}

TEST(Retry, GivesUpBeforeTheDeadlineWouldPass) {
  FakeTime time;
  const auto status = retry(within(1s, exponential_backoff(kNoJitter)), time.waiter(),
                            [] { return failure(ErrorCode::kUnavailable); });
  EXPECT_FALSE(status.has_value());
  EXPECT_EQ(time.waits, (std::vector<Duration>{100ms, 200ms, 400ms}));
}

TEST(Retry, GivesUpWhenInterrupted) {
  FakeTime time;
  time.interrupted = true;
  int attempts = 0;
  const auto status = retry(exponential_backoff(kNoJitter), time.waiter(), [&] {
    ++attempts;
    return failure(ErrorCode::kUnavailable);
  });
  EXPECT_FALSE(status.has_value());
  EXPECT_EQ(attempts, 1);
}

// Attempts of ten seconds each, of which the first few make progress.
TEST(RetryLong, TheTimeoutRestartsWithProgress) {
  FakeTime time;
  int attempts = 0;
  const auto status =
      retry_long(within(30s, exponential_backoff(kNoJitter)), time.waiter(), [&](bool& progress) {
        time.now += 10s;
        if (++attempts <= 9) progress = true;
        return failure(ErrorCode::kUnavailable);
      });
  EXPECT_FALSE(status.has_value());
  EXPECT_EQ(attempts, 9 + 3);
  EXPECT_EQ(time.waits[8], 100ms) << "as after the first";
  EXPECT_EQ(time.waits[9], 200ms);
}

TEST(RetryLong, TheFirstAttemptMayTakeAsLongAsItWants) {
  FakeTime time;
  int attempts = 0;
  const auto status =
      retry_long(within(1s, exponential_backoff(kNoJitter)), time.waiter(), [&](bool&) -> core::Status {
        time.now += 10min;
        return ++attempts < 2 ? failure(ErrorCode::kUnavailable) : core::Status{};
      });
  EXPECT_TRUE(status.has_value());
  EXPECT_EQ(attempts, 2);
}

}  // namespace
}  // namespace tessera::proto
