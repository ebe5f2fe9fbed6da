// SPDX-License-Identifier: Apache-2.0
// The output of `render --stats`. docs/command-line.md lists the fields; benchmarks depend on their names.
#pragma once

#include <cstdint>
#include <string>

#include "core/film/film.hpp"
#include "core/scene/settings.hpp"

namespace tessera::client {

struct RenderStats {
  core::RenderSettings settings;
  core::RenderCounters counters;
  int threads = 0;
  bool is_complete = true;         // or stopped before the last sample
  double load_seconds = 0;         // reading the scene file and its assets
  double build_seconds = 0;        // validation, acceleration structure
  double render_seconds = 0;       // taking samples
  double render_core_seconds = 0;  // of all cores together, while they did
};

// Processor time of all threads of this process so far, in seconds.
double core_seconds();

// The largest resident size of this process so far.
std::uint64_t peak_memory_bytes();

// One JSON object and a line end.
std::string to_json(const RenderStats& stats, std::uint64_t peak_memory_bytes);

}  // namespace tessera::client
