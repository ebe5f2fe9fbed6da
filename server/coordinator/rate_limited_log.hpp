// SPDX-License-Identifier: Apache-2.0
// A log for warnings that callers can cause thousands of times a second: one line in ten seconds, with the
// number of suppressed ones. Not thread-safe.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "server/scheduler/types.hpp"

namespace tessera::coordinator {

class RateLimitedLog {
 public:
  void warn(std::string sentence, scheduler::Time now);
  // Logs the last suppressed sentence if it is due. Call it regularly.
  void flush(scheduler::Time now);
  // The time until flush() has something to log; empty if no sentence was suppressed.
  std::optional<scheduler::Duration> due_in(scheduler::Time now) const;

 private:
  std::string sentence_;
  std::size_t times_ = 0;  // since the last line
  scheduler::Time next_ = scheduler::Time::min();
};

}  // namespace tessera::coordinator
