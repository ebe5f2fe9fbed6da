// SPDX-License-Identifier: Apache-2.0
// Starts a real coordinator with simulated workers, submits jobs, measures for some time, and ends it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/scale/measured_coordinator.hpp"
#include "bench/scale/simulated_worker.hpp"
#include "bench/scale/tally.hpp"
#include "core/base/error.hpp"
#include "core/film/layers.hpp"

namespace tessera::bench {

struct Load {
  std::string name;
  int workers = 1;
  Speed speed;
  int jobs = 1;
  // The size of each job's image in pixels; multiples of 64.
  int width_px = 64, height_px = 64;
  std::uint32_t spp = 1 << 16;
  double warm_up_seconds = 10, measured_seconds = 20;
  // Measures until all jobs are done, but at most for the given time.
  bool until_done = false;
  std::optional<int> coordinator_core{};
  std::vector<std::string> coordinator_options{};
  core::LayerSet layers{};  // of each job
  // Clients that watch the tiles of the first job.
  int watchers = 0;
  // Browsers that show it. Workers are there before the job then, as on a farm that waits for work.
  int page_viewers = 0;
};

struct Figures {
  Counts counts;  // during the measurement
  double seconds = 0;
  Usage before_jobs, before, after;  // before the first job, and at the start and end of the measurement
  double own_cpu_seconds = 0;        // of the simulated workers during the measurement
  std::uint64_t film_bytes = 0;      // 48 for each pixel of the tiles that had samples at the end
  bool all_done = false;
  // What all watchers received during the measurement.
  std::uint64_t watched_tiles = 0, watched_bytes = 0;
  // Of browsers: from the answer to the submission to the first pixels, and from counting samples to showing
  // them.
  double first_pixel_seconds = 0;
  std::vector<double> shown_seconds{};
};

// Fails if a process cannot be started, or if the coordinator rejects a call.
core::Result<Figures> measure(const Load& load, const std::filesystem::path& coordinator_program);

}  // namespace tessera::bench
