// SPDX-License-Identifier: Apache-2.0
// When to try again, as policies that compose: within(minutes, transient_only(exponential_backoff())).
// Time and waiting are arguments, so that tests need neither. A policy keeps no state between uses, except
// that exponential_backoff draws its jitter from a generator: give each thread its own.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>

#include "core/base/error.hpp"

namespace tessera::proto {

using Duration = std::chrono::steady_clock::duration;

// The attempts of one call so far, all without progress.
struct Attempts {
  core::ErrorCode last_code = core::ErrorCode::kUnavailable;
  int count = 1;
  Duration elapsed{};  // since before the first attempt
};

// How long to wait before the next attempt, or nothing: give up.
using RetryPolicy = std::function<std::optional<Duration>(const Attempts&)>;

struct BackoffOptions {
  Duration first = std::chrono::milliseconds(100);
  Duration longest = std::chrono::seconds(5);
  double growth = 2;
  double jitter = 0.5;  // each wait is shortened by up to this part of it, at random, so that a farm does not
                        // knock in step
};

// From the operating system.
std::uint64_t random_seed();

// Forever, whatever the error.
RetryPolicy exponential_backoff(BackoffOptions options = {}, std::uint64_t seed = random_seed());

// Only errors that may pass by themselves: UNAVAILABLE, DEADLINE_EXCEEDED.
RetryPolicy transient_only(RetryPolicy inner);
bool is_transient(core::ErrorCode code);

// Gives up where the next attempt would start later than `total` after the first.
RetryPolicy within(Duration total, RetryPolicy inner);

// Time as retry() needs it.
struct Waiter {
  std::function<Duration()> now;       // on any steady clock
  std::function<bool(Duration)> wait;  // false where the wait was interrupted: retry() gives up
};
// The steady clock and a plain sleep.
Waiter real_time();

// Calls `attempt` until it succeeds or `policy` gives up, and answers with its last result.
core::Status retry(const RetryPolicy& policy, const Waiter& waiter,
                   const std::function<core::Status()>& attempt);

// The same for attempts that can take long, each of which sets its argument once something got through.
// Attempts and time are counted from the end of the last one that did, or of the first: patience is with a
// peer that takes nothing.
core::Status retry_long(const RetryPolicy& policy, const Waiter& waiter,
                        const std::function<core::Status(bool& progress)>& attempt);

}  // namespace tessera::proto
