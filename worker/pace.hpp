// SPDX-License-Identifier: Apache-2.0
// Chooses the size of pieces, so that a worker reacts to answers within about a quarter of a second, whatever
// the scene costs. Not thread-safe.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string>

#include "core/film/region.hpp"

namespace tessera::worker {

class Pace {
 public:
  // Pixel samples for the next piece of this job: one sample per pixel of a tile while the speed is unknown.
  std::uint64_t target_samples(const std::string& job_id) const {
    return job_id == job_id_ ? target_ : kFirstSamples;
  }

  // Records the time that rendering so many samples took.
  void measured(const std::string& job_id, std::uint64_t samples, std::chrono::duration<double> took) {
    const double fitting = static_cast<double>(samples) * kPieceSeconds / std::max(took.count(), 1e-6);
    // Growth is limited, since a tile of sky says little about the next one.
    const double most = static_cast<double>(kMaxGrowth * std::max(samples, kFirstSamples));
    job_id_ = job_id;
    target_ = static_cast<std::uint64_t>(std::min(fitting, most));
  }

 private:
  static constexpr std::uint64_t kFirstSamples = core::kTilePx * core::kTilePx;
  static constexpr std::uint64_t kMaxGrowth = 4;
  static constexpr double kPieceSeconds = 0.25;

  std::string job_id_;
  std::uint64_t target_ = kFirstSamples;
};

}  // namespace tessera::worker
