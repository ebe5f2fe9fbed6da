// SPDX-License-Identifier: Apache-2.0
// Thins out lines that callers can cause thousands of times a second: a few in ten seconds, with the number
// of suppressed ones. Logs nothing itself, so that its owner can release a lock before. Not thread-safe.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>

#include "core/common/log_fields.hpp"

namespace tessera::common {

class RateLimitedLog {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Duration = std::chrono::steady_clock::duration;

  // At most so many lines in ten seconds.
  explicit RateLimitedLog(std::size_t max_lines = 1) : max_lines_(max_lines) {}

  // Returns the line to log, if one is due.
  std::optional<LogLine> note(LogLine line, Time now);
  // Returns the last suppressed line, if it is due. Call it regularly.
  std::optional<LogLine> take_due(Time now);
  // The time until take_due() has something to log; empty if no line was suppressed.
  std::optional<Duration> due_in(Time now) const;

 private:
  const std::size_t max_lines_;
  LogLine line_{};
  std::size_t times_ = 0;  // since the last line
  std::size_t left_ = 0;   // until `next_`
  Time next_ = Time::min();
};

}  // namespace tessera::common
