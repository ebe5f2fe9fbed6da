// SPDX-License-Identifier: Apache-2.0
// How many scenes were validated, with which outcome, and how long that took. Thread-safe.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <stop_token>
#include <utility>
#include <vector>

#include "server/base/duration_histogram.hpp"
#include "server/jobs/job_service.hpp"

namespace tessera::jobs {

struct ValidationStats {
  std::atomic<std::uint64_t> accepted{0}, rejected{0};
  // Validations that came to no result: for lack of memory, or since the coordinator stops.
  std::atomic<std::uint64_t> failed{0};
  base::DurationHistogram durations{bounds()};

 private:
  static std::vector<std::chrono::nanoseconds> bounds() {
    using std::chrono::milliseconds;
    return {milliseconds(10),     milliseconds(50),     milliseconds(100),
            milliseconds(500),    milliseconds(1000),   milliseconds(5000),
            milliseconds(15'000), milliseconds(60'000), milliseconds(300'000)};
  }
};

// The same check, which counts what it does. `stats` must outlive it.
inline SceneCheck counted(SceneCheck check, ValidationStats& stats) {
  return [check = std::move(check), &stats](const v1::Bundle& bundle, const v1::RenderOverrides& overrides,
                                            const std::vector<int>& frames, const std::stop_token& stop) {
    const auto begin = std::chrono::steady_clock::now();
    auto checked = check(bundle, overrides, frames, stop);
    stats.durations.observe(std::chrono::steady_clock::now() - begin);
    if (checked) {
      ++stats.accepted;
    } else {
      ++(checked.error().code == core::ErrorCode::kInvalidArgument ? stats.rejected : stats.failed);
    }
    return checked;
  };
}

}  // namespace tessera::jobs
