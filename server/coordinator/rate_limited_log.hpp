// SPDX-License-Identifier: Apache-2.0
// Warnings that callers can cause a thousand times a second: one line in ten seconds, with the number of
// those that were left out. Not thread-safe.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "server/scheduler/types.hpp"

namespace tessera::coordinator {

class RateLimitedLog {
 public:
  void warn(std::string sentence, scheduler::Time now);
  // Logs the last sentence that was left out, if it is time. To be called regularly.
  void flush(scheduler::Time now);
  // How long until flush() has something to log; nothing if no sentence was left out.
  std::optional<scheduler::Duration> due_in(scheduler::Time now) const;

 private:
  std::string sentence_;
  std::size_t times_ = 0;  // since the last line
  scheduler::Time next_ = scheduler::Time::min();
};

}  // namespace tessera::coordinator
