// SPDX-License-Identifier: Apache-2.0
#include "server/coordinator/rate_limited_log.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace tessera::coordinator {

namespace {

constexpr auto kPeriod = std::chrono::seconds(10);

}  // namespace

void RateLimitedLog::warn(std::string sentence, scheduler::Time now) {
  sentence_ = std::move(sentence);
  ++times_;
  flush(now);
}

void RateLimitedLog::flush(scheduler::Time now) {
  if (times_ == 0 || now < next_) return;
  spdlog::warn("{}{}", sentence_, times_ == 1 ? "" : fmt::format(" ({} such since the last line)", times_));
  times_ = 0;
  next_ = now + kPeriod;
}

std::optional<scheduler::Duration> RateLimitedLog::due_in(scheduler::Time now) const {
  if (times_ == 0) return std::nullopt;
  return std::max<scheduler::Duration>(scheduler::Duration::zero(), next_ - now);
}

}  // namespace tessera::coordinator
