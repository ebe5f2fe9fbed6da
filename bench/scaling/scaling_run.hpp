// SPDX-License-Identifier: Apache-2.0
// One render by a farm of simulated workers, which wait for the time that rendering would take: how much of
// their time becomes samples of the image. The coordinator and all connections are real.
#pragma once

#include <cstdint>
#include <filesystem>

#include "core/base/error.hpp"
#include "core/film/region.hpp"

namespace tessera::bench {

// Every worker has the same speed, of one core.
inline constexpr double kSamplesPerCoreSecond = 100'000;
inline constexpr int kScalingWidthPx = 1920, kScalingHeightPx = 1088;

struct ScalingRun {
  int workers = 1;
  // Whether all tiles cost the same. Otherwise one in ten, in one region of the image, costs twenty times as
  // much as each of the others; the mean is the same.
  bool is_balanced = true;
  // The share of the workers that are killed, at times spread over the render, and not replaced.
  double dying_share = 0;
  // The time that the render takes if every core is always busy with samples that count.
  double ideal_seconds = 120;

  // The nearest number of samples per pixel, at least 1.
  std::uint32_t spp() const;
  int dying() const;
};

struct ScalingFigures {
  double seconds = 0;  // from the submission until the job is done
  // Of all workers, from the submission until the job is done or they were killed.
  double core_seconds = 0;
  double useful_samples = 0;  // pixel samples of the image
  // From the submission until the last worker begins to render; negative if one never did.
  double all_busy_seconds = -1;
  double duplicate_share =
      0;  // of the rendering time: delivered, and others were first, or lost with a worker
  double coordinator_cpu_seconds = 0, workers_cpu_seconds = 0;

  // 1 if every second of every core becomes samples that count.
  double efficiency() const { return useful_samples / (core_seconds * kSamplesPerCoreSecond); }
};

// The cost of a sample of a tile of the unbalanced scene; its mean over the image is 1.
double unbalanced_cost(const core::PixelRect& tile);

// Blocks until the job is done. Fails if a process cannot be started, or if the coordinator rejects a call.
core::Result<ScalingFigures> measure(const ScalingRun& run, const std::filesystem::path& coordinator_program);

}  // namespace tessera::bench
