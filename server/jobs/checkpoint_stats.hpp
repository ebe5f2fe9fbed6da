// SPDX-License-Identifier: Apache-2.0
// How long checkpoints take, how many fail, and when the last one was written. Thread-safe.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <vector>

#include "server/base/duration_histogram.hpp"

namespace tessera::jobs {

class CheckpointStats {
 public:
  using Clock = std::chrono::steady_clock;

  // A checkpoint that began at this time has ended now.
  void note(Clock::time_point begin, bool written) {
    durations_.observe(Clock::now() - begin);
    if (written) {
      last_written_ = begin;
    } else {
      ++failed_;
    }
  }

  const base::DurationHistogram& durations() const { return durations_; }
  std::uint64_t failed() const { return failed_; }
  // The time since the last checkpoint that was written, or since the start of the coordinator: a crash now
  // would cost the work of this time.
  Clock::duration age() const { return Clock::now() - last_written_.load(); }

 private:
  static std::vector<std::chrono::nanoseconds> bounds() {
    using std::chrono::milliseconds;
    return {milliseconds(1),    milliseconds(5),     milliseconds(10),   milliseconds(50),
            milliseconds(100),  milliseconds(500),   milliseconds(1000), milliseconds(2500),
            milliseconds(5000), milliseconds(30'000)};
  }

  base::DurationHistogram durations_{bounds()};
  std::atomic<std::uint64_t> failed_{0};
  std::atomic<Clock::time_point> last_written_{Clock::now()};
};

}  // namespace tessera::jobs
