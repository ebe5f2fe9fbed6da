// SPDX-License-Identifier: Apache-2.0
// Limits how often each caller may call, with token buckets. A bucket refills at a fixed rate and holds the
// tokens of kBurstSeconds. Thread-safe.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "core/base/mutex.hpp"

namespace tessera::auth {

class CallRate {
 public:
  using Clock = std::chrono::steady_clock;

  explicit CallRate(double calls_per_second, std::function<Clock::time_point()> now = Clock::now);

  // Takes a token of the caller. If there is none, returns the time until there is one.
  std::optional<Clock::duration> take(const std::string& caller);

  double calls_per_second() const { return calls_per_second_; }

 private:
  struct Bucket {
    double tokens;
    Clock::time_point filled_at;
  };
  // The tokens in a bucket at this moment.
  double tokens(const Bucket& bucket, Clock::time_point now) const;
  // Removes full buckets: they equal new ones.
  void forget_full(Clock::time_point now) TESSERA_REQUIRES(mutex_);

  const double calls_per_second_, capacity_;
  const std::function<Clock::time_point()> now_;
  core::Mutex mutex_;
  std::map<std::string, Bucket> buckets_ TESSERA_GUARDED_BY(mutex_);
  std::size_t forget_at_ TESSERA_GUARDED_BY(mutex_);  // full buckets are removed at this number
};

}  // namespace tessera::auth
