// SPDX-License-Identifier: Apache-2.0
#include "core/common/rate_limited_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

namespace tessera::common {

namespace {

constexpr auto kPeriod = std::chrono::seconds(10);

}  // namespace

std::optional<LogLine> RateLimitedLog::note(LogLine line, Time now) {
  line_ = std::move(line);
  ++times_;
  return take_due(now);
}

std::optional<LogLine> RateLimitedLog::take_due(Time now) {
  if (times_ == 0) return std::nullopt;
  if (now >= next_) {
    left_ = max_lines_;
    next_ = now + kPeriod;
  }
  if (left_ == 0) return std::nullopt;
  --left_;
  LogLine line = line_;
  if (times_ > 1) line.message += fmt::format(" ({} such since the last line)", times_);
  times_ = 0;
  return line;
}

std::optional<RateLimitedLog::Duration> RateLimitedLog::due_in(Time now) const {
  if (times_ == 0) return std::nullopt;
  return std::max<Duration>(Duration::zero(), next_ - now);
}

}  // namespace tessera::common
