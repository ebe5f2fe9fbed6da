// SPDX-License-Identifier: Apache-2.0
#include "client/render_stats.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace tessera::client {
namespace {

TEST(RenderStats, JsonHasEveryField) {
  RenderStats stats;
  stats.settings = {.width_px = 640, .height_px = 480, .spp = 4, .seed = 18446744073709551615u};
  stats.settings.integrator = core::Integrator::kNee;
  stats.counters.samples = 1'228'800;
  stats.counters.closest_hit_rays = 5'000'000;
  stats.counters.shadow_rays = 3'000'000;
  stats.counters.non_finite_samples = 1;
  stats.counters.saturated_samples = 2;
  stats.threads = 8;
  stats.is_complete = false;
  stats.load_seconds = 0.5;
  stats.build_seconds = 0.25;
  stats.render_seconds = 2;
  stats.render_core_seconds = 7;
  const nlohmann::json expected = {
      {"width", 640},
      {"height", 480},
      {"crop", nullptr},
      {"spp", 4},
      {"integrator", "nee"},
      {"heuristic", "balance"},
      {"clamp_indirect", 0.0},
      {"seed", 18446744073709551615u},
      {"threads", 8},
      {"complete", false},
      {"samples", 1'228'800},
      {"closest_hit_rays", 5'000'000},
      {"shadow_rays", 3'000'000},
      {"non_finite_samples", 1},
      {"saturated_samples", 2},
      {"load_seconds", 0.5},
      {"build_seconds", 0.25},
      {"render_seconds", 2.0},
      {"render_core_seconds", 7.0},
      {"samples_per_second", 614'400.0},
      {"peak_memory_bytes", 123'456'789},
  };
  nlohmann::json actual = nlohmann::json::parse(to_json(stats, 123'456'789));
  for (const char* of_this_build : {"version", "instruction_set"}) {
    EXPECT_TRUE(actual.contains(of_this_build));
    actual.erase(of_this_build);
  }
  EXPECT_EQ(actual, expected);
  stats.settings.crop = core::PixelRect{10, 20, 330, 40};
  EXPECT_EQ(nlohmann::json::parse(to_json(stats, 0))["crop"], nlohmann::json({10, 20, 330, 40}));
}

TEST(RenderStats, ProcessorTimePassesWithWork) {
  const double before = core_seconds();
  while (core_seconds() < before + 0.02) {
  }
  EXPECT_LT(core_seconds(), before + 10);
}

TEST(RenderStats, PeakMemoryIsInBytes) {
  EXPECT_GT(peak_memory_bytes(), std::uint64_t{1} << 20);
  EXPECT_LT(peak_memory_bytes(), std::uint64_t{1} << 40);
}

}  // namespace
}  // namespace tessera::client
