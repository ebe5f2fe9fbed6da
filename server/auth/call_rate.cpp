// SPDX-License-Identifier: Apache-2.0
#include "server/auth/call_rate.hpp"

#include <algorithm>
#include <utility>

#include "server/limits.hpp"

namespace tessera::auth {

namespace {

constexpr std::size_t kFewBuckets = 1024;
using Seconds = std::chrono::duration<double>;

}  // namespace

CallRate::CallRate(double calls_per_second, std::function<Clock::time_point()> now)
    : calls_per_second_(calls_per_second),
      capacity_(std::max(1.0, calls_per_second * server::kBurstSeconds)),
      now_(std::move(now)),
      forget_at_(kFewBuckets) {}

std::optional<CallRate::Clock::duration> CallRate::take(const std::string& caller) {
  const core::MutexLock lock(mutex_);
  const Clock::time_point now = now_();
  if (buckets_.size() >= forget_at_) forget_full(now);
  Bucket& bucket = buckets_.try_emplace(caller, Bucket{capacity_, now}).first->second;
  bucket = {tokens(bucket, now), now};
  if (bucket.tokens < 1) {
    const Seconds wait((1 - bucket.tokens) / calls_per_second_);
    return std::chrono::ceil<std::chrono::milliseconds>(wait);
  }
  bucket.tokens -= 1;
  return std::nullopt;
}

double CallRate::tokens(const Bucket& bucket, Clock::time_point now) const {
  return std::min(capacity_, bucket.tokens + Seconds(now - bucket.filled_at).count() * calls_per_second_);
}

void CallRate::forget_full(Clock::time_point now) {
  std::erase_if(buckets_, [&](const auto& entry) { return tokens(entry.second, now) >= capacity_; });
  forget_at_ = std::max(kFewBuckets, 2 * buckets_.size());
}

}  // namespace tessera::auth
