// SPDX-License-Identifier: Apache-2.0
// Counts durations by their length, for metrics. Lock-free; thread-safe.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace tessera::base {

class DurationHistogram {
 public:
  using Duration = std::chrono::nanoseconds;

  // The upper bounds of the buckets, inclusive and ascending. A last bucket takes what is longer.
  explicit DurationHistogram(std::vector<Duration> bounds)
      : bounds_(std::move(bounds)),
        counts_(std::make_unique<std::atomic<std::uint64_t>[]>(bounds_.size() + 1)) {}

  void observe(Duration duration) {
    std::size_t bucket = 0;
    while (bucket < bounds_.size() && duration > bounds_[bucket]) ++bucket;
    counts_[bucket].fetch_add(1, std::memory_order_relaxed);
    sum_ns_.fetch_add(duration.count(), std::memory_order_relaxed);
  }

  const std::vector<Duration>& bounds() const { return bounds_; }

  struct Snapshot {
    std::vector<std::uint64_t> counts;  // of each bucket; one more than there are bounds
    Duration sum{};
  };
  // While others observe, the sum may include durations that the counts do not.
  Snapshot snapshot() const {
    Snapshot result;
    for (std::size_t i = 0; i <= bounds_.size(); ++i)
      result.counts.push_back(counts_[i].load(std::memory_order_relaxed));
    result.sum = Duration(sum_ns_.load(std::memory_order_relaxed));
    return result;
  }

 private:
  const std::vector<Duration> bounds_;
  const std::unique_ptr<std::atomic<std::uint64_t>[]> counts_;
  std::atomic<Duration::rep> sum_ns_{0};
};

}  // namespace tessera::base
