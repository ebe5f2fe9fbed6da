// SPDX-License-Identifier: Apache-2.0
// One farm of simulated workers around a real coordinator: starts it, submits jobs, measures for a while,
// and stops it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "bench/scale/measured_coordinator.hpp"
#include "bench/scale/simulated_worker.hpp"
#include "bench/scale/tally.hpp"
#include "core/base/error.hpp"

namespace tessera::bench {

struct Load {
  std::string name;
  int workers = 1;
  Speed speed;
  int jobs = 1;
  // The image size of each job in pixels; multiples of 64.
  int width_px = 64, height_px = 64;
  std::uint32_t spp = 1 << 16;
  double warm_up_seconds = 10, measured_seconds = 20;
  // Measures until all jobs are done, for at most this long.
  bool until_done = false;
  std::optional<int> coordinator_core;
};

struct Figures {
  Counts counts;  // within the measured time
  double seconds = 0;
  Usage before_jobs, before, after;  // before the first job, and at both ends of the measured time
  double own_cpu_seconds = 0;        // of the simulated workers, within it
  std::uint64_t film_bytes = 0;      // 48 for each pixel of the tiles that had samples in the end
  bool all_done = false;
};

// Errors: a process cannot be started, or the coordinator rejects a call.
core::Result<Figures> measure(const Load& load, const std::filesystem::path& coordinator_program);

}  // namespace tessera::bench
