// SPDX-License-Identifier: Apache-2.0
// A rate per second, averaged with weights that decay with age.
#pragma once

#include <algorithm>
#include <cmath>

#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

class RateMeter {
 public:
  void add(double count, Time now) {
    if (!started_) last_ = now;
    started_ = true;
    advance(now);
    count_ += count;
  }

  // 0 during the first half second.
  double per_second(Time now) const {
    if (!started_) return 0;
    RateMeter at_now = *this;
    at_now.advance(now);
    return at_now.seconds_ < 0.5 ? 0 : at_now.count_ / at_now.seconds_;
  }

 private:
  static constexpr double kMemorySeconds = 8.0;

  // Count and elapsed time decay alike, so that their ratio is right from the start.
  void advance(Time now) {
    const double elapsed = std::max(std::chrono::duration<double>(now - last_).count(), 0.0);
    const double kept = std::exp(-elapsed / kMemorySeconds);
    count_ *= kept;
    seconds_ = seconds_ * kept + kMemorySeconds * (1 - kept);
    last_ = std::max(last_, now);
  }

  bool started_ = false;
  Time last_{};
  double count_ = 0;
  double seconds_ = 0;
};

}  // namespace tessera::scheduler
