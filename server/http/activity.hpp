// SPDX-License-Identifier: Apache-2.0
// What the farm has done in the last hours, for the plots of pages that are opened later. Thread-safe.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "core/base/mutex.hpp"
#include "server/farm/totals.hpp"

namespace tessera::http_api {

struct ActivitySample {
  double samples_per_second = 0;
  std::uint64_t busy_workers = 0;
  std::uint64_t running_jobs = 0;  // also those that wait for workers
  bool operator==(const ActivitySample&) const = default;
};

ActivitySample activity_of(const farm::Totals& totals);

class ActivityLog {
 public:
  static constexpr std::chrono::seconds kPeriod{10};
  static constexpr std::size_t kKept = std::chrono::hours(3) / kPeriod;

  // To be called every kPeriod. The oldest sample gives way.
  void add(const ActivitySample& sample);
  // Oldest first.
  std::vector<ActivitySample> samples() const;

 private:
  mutable core::Mutex mutex_;
  std::deque<ActivitySample> samples_ TESSERA_GUARDED_BY(mutex_);
};

}  // namespace tessera::http_api
