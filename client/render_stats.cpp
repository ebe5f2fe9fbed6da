// SPDX-License-Identifier: Apache-2.0
#include "client/render_stats.hpp"

#include <sys/resource.h>

#include <nlohmann/json.hpp>

#include "core/base/instruction_set.hpp"
#include "core/base/version.hpp"

namespace tessera::client {

namespace {

nlohmann::json crop_json(const core::RenderSettings& settings) {
  if (!settings.crop) return nullptr;
  const auto& [x0, y0, x1, y1] = *settings.crop;
  return nlohmann::json::array({x0, y0, x1, y1});
}

}  // namespace

double core_seconds() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

std::uint64_t peak_memory_bytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

std::string to_json(const RenderStats& stats, std::uint64_t peak_memory_bytes) {
  const core::RenderCounters& counters = stats.counters;
  const double speed =
      stats.render_seconds > 0 ? static_cast<double>(counters.samples) / stats.render_seconds : 0;
  const nlohmann::ordered_json json = {
      {"version", core::version()},
      {"width", stats.settings.width_px},
      {"height", stats.settings.height_px},
      {"crop", crop_json(stats.settings)},
      {"spp", stats.settings.spp},
      {"integrator", core::integrator_name(stats.settings.integrator)},
      {"heuristic", core::heuristic_name(stats.settings.heuristic)},
      {"clamp_indirect", stats.settings.clamp_indirect},
      {"seed", stats.settings.seed},
      {"threads", stats.threads},
      {"instruction_set", core::instruction_set()},
      {"complete", stats.is_complete},
      {"samples", counters.samples},
      {"closest_hit_rays", counters.closest_hit_rays},
      {"shadow_rays", counters.shadow_rays},
      {"non_finite_samples", counters.non_finite_samples},
      {"saturated_samples", counters.saturated_samples},
      {"load_seconds", stats.load_seconds},
      {"build_seconds", stats.build_seconds},
      {"render_seconds", stats.render_seconds},
      {"render_core_seconds", stats.render_core_seconds},
      {"samples_per_second", speed},
      {"peak_memory_bytes", peak_memory_bytes},
  };
  return json.dump(2) + "\n";
}

}  // namespace tessera::client
