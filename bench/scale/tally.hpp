// SPDX-License-Identifier: Apache-2.0
// Counters of the simulated workers of one farm during the measurement. Thread-safe.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

#include "core/film/region.hpp"

namespace tessera::bench {

struct Counts {
  std::uint64_t results = 0;  // answered SubmitResults
  std::uint64_t items = 0;    // those that were accepted
  std::uint64_t dropped_items = 0;
  std::uint64_t samples = 0;  // pixel samples of all items that were sent
  std::uint64_t leases = 0;
  std::uint64_t synchronizes = 0;
  std::uint64_t sent_bytes = 0;      // of both kinds of messages, without framing
  std::uint64_t received_bytes = 0;  // of the answers
  std::uint64_t failed_calls = 0;
  double rendering_seconds = 0;                                      // the sum over all workers
  std::vector<std::chrono::steady_clock::time_point> first_renders;  // of workers: when the first one began
  // From sending a result to the answer that accepts it.
  std::vector<double> submit_seconds;
  // From sending a lease's last result to receiving another lease.
  std::vector<double> next_lease_seconds;
};

class Tally {
 public:
  // `counted` is called with the tile of each item whose result is answered.
  explicit Tally(std::function<void(const core::PixelRect&)> counted = [](const core::PixelRect&) {})
      : counted_(std::move(counted)) {}

  void note_counted(const core::PixelRect& rect) { counted_(rect); }
  // Changes the counters during the measurement; does nothing otherwise.
  template <typename Change>
  void note(Change change) {
    const std::lock_guard lock(mutex_);
    if (counting_) change(counts_);
  }

  void start() {
    const std::lock_guard lock(mutex_);
    counts_ = {};
    counting_ = true;
  }
  Counts stop() {
    const std::lock_guard lock(mutex_);
    counting_ = false;
    return counts_;
  }

 private:
  const std::function<void(const core::PixelRect&)> counted_;
  std::mutex mutex_;
  bool counting_ = false;
  Counts counts_;
};

// The value below which this share of them lies; 0 if there are none.
double quantile(std::vector<double> values, double share);

}  // namespace tessera::bench
