// SPDX-License-Identifier: Apache-2.0
#include "proto/retry.hpp"

#include <algorithm>
#include <random>
#include <thread>
#include <utility>

namespace tessera::proto {

std::uint64_t random_seed() {
  std::random_device device;
  return (std::uint64_t{device()} << 32) | device();
}

RetryPolicy exponential_backoff(BackoffOptions options, std::uint64_t seed) {
  return
      [options, random = std::mt19937_64(seed)](const Attempts& attempts) mutable -> std::optional<Duration> {
        using Seconds = std::chrono::duration<double>;
        double wait_s = Seconds(options.first).count();
        const double longest_s = Seconds(options.longest).count();
        for (int i = 1; i < attempts.count && wait_s < longest_s; ++i) wait_s *= options.growth;
        const double shortening = options.jitter * std::uniform_real_distribution<double>(0, 1)(random);
        return std::chrono::duration_cast<Duration>(Seconds(std::min(wait_s, longest_s) * (1 - shortening)));
      };
}

bool is_transient(core::ErrorCode code) {
  return code == core::ErrorCode::kUnavailable || code == core::ErrorCode::kDeadlineExceeded;
}

RetryPolicy transient_only(RetryPolicy inner) {
  return [inner = std::move(inner)](const Attempts& attempts) -> std::optional<Duration> {
    if (!is_transient(attempts.last_code)) return std::nullopt;
    return inner(attempts);
  };
}

RetryPolicy within(Duration total, RetryPolicy inner) {
  return [total, inner = std::move(inner)](const Attempts& attempts) -> std::optional<Duration> {
    const std::optional<Duration> wait = inner(attempts);
    if (wait && attempts.elapsed + *wait > total) return std::nullopt;
    return wait;
  };
}

Waiter real_time() {
  return {[] { return std::chrono::steady_clock::now().time_since_epoch(); },
          [](Duration duration) {
            std::this_thread::sleep_for(duration);
            return true;
          }};
}

core::Status retry(const RetryPolicy& policy, const Waiter& waiter,
                   const std::function<core::Status()>& attempt) {
  const Duration start = waiter.now();
  for (int count = 1;; ++count) {
    core::Status status = attempt();
    if (status) return status;
    const std::optional<Duration> wait = policy({status.error().code, count, waiter.now() - start});
    if (!wait || !waiter.wait(*wait)) return status;
  }
}

core::Status retry_long(const RetryPolicy& policy, const Waiter& waiter,
                        const std::function<core::Status(bool& progress)>& attempt) {
  Duration start{};
  for (int count = 1;; ++count) {
    bool progress = count == 1;
    core::Status status = attempt(progress);
    if (status) return status;
    if (progress) {
      start = waiter.now();
      count = 1;
    }
    const std::optional<Duration> wait = policy({status.error().code, count, waiter.now() - start});
    if (!wait || !waiter.wait(*wait)) return status;
  }
}

}  // namespace tessera::proto
