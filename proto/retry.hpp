// SPDX-License-Identifier: Apache-2.0
// Retry policies that compose: within(minutes, transient_only(exponential_backoff())). Time and waiting are
// arguments, so that tests need neither. A policy keeps no state between uses, except that
// exponential_backoff draws its jitter from a generator: give each thread its own.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>

#include "core/base/error.hpp"

namespace tessera::proto {

using Duration = std::chrono::steady_clock::duration;

// The attempts of one call so far, all failed.
struct Attempts {
  core::ErrorCode last_code = core::ErrorCode::kUnavailable;
  int count = 1;
  Duration elapsed{};  // since before the first attempt
};

// The time to wait before the next attempt; empty: give up.
using RetryPolicy = std::function<std::optional<Duration>(const Attempts&)>;

struct BackoffOptions {
  Duration first = std::chrono::milliseconds(100);
  Duration longest = std::chrono::seconds(5);
  double growth = 2;
  double jitter = 0.5;  // the random part of each wait, against a thundering herd
};

// A seed from the operating system.
std::uint64_t random_seed();

// Retries for ever, after any error.
RetryPolicy exponential_backoff(BackoffOptions options = {}, std::uint64_t seed = random_seed());

// Retries only after temporary errors: UNAVAILABLE, DEADLINE_EXCEEDED.
RetryPolicy transient_only(RetryPolicy inner);
bool is_transient(core::ErrorCode code);

// Gives up if the next attempt would start later than `total` after the first.
RetryPolicy within(Duration total, RetryPolicy inner);

// The clock and the wait that retry() uses.
struct Waiter {
  std::function<Duration()> now;       // any steady clock
  std::function<bool(Duration)> wait;  // false if the wait was interrupted: retry() gives up
};
// The steady clock and a plain sleep.
Waiter real_time();

// Calls `attempt` until it succeeds or `policy` gives up. Returns its last result.
core::Status retry(const RetryPolicy& policy, const Waiter& waiter,
                   const std::function<core::Status()>& attempt);

// The same for attempts that can take long. An attempt sets its argument when it has made progress. The
// policy counts attempts and time from the end of the last attempt with progress, or from the first attempt:
// it limits the time without progress.
core::Status retry_long(const RetryPolicy& policy, const Waiter& waiter,
                        const std::function<core::Status(bool& progress)>& attempt);

}  // namespace tessera::proto
