// SPDX-License-Identifier: Apache-2.0
// The mean of a render with its error, for comparison with what is known in closed form.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/integrators/render.hpp"
#include "core/integrators/render_plan.hpp"
#include "tests/support/effort.hpp"

namespace tessera::test {

struct Mean {
  double value = 0, standard_error = 0;
};

// A way to find light that is unbiased.
struct Strategy {
  const char* name;
  core::Integrator integrator;
  core::Heuristic heuristic = core::Heuristic::kBalance;
};
inline constexpr Strategy kStrategies[] = {{"naive", core::Integrator::kNaive},
                                           {"nee", core::Integrator::kNee},
                                           {"mis by balance", core::Integrator::kMis},
                                           {"mis by power", core::Integrator::kMis, core::Heuristic::kPower}};

// The mean radiance (red channel) of every pixel's first `spp` samples, with the error of that mean. The
// settings' size and spp do not count; the plan is for their integrator.
inline Mean mean_radiance(const core::integrators::RenderPlan& plan, core::RenderSettings settings,
                          std::uint32_t spp, int side_px = 4) {
  settings.width_px = settings.height_px = side_px;
  settings.spp = spp;
  double sum = 0, sum2 = 0;
  const int n = side_px * side_px;
  const core::FilmTile tile = render(plan.with(settings), {0, 0, side_px, side_px}, {0, spp}, 2);
  for (int p = 0; p < n; ++p) {
    const double v = static_cast<double>(tile.sums[static_cast<std::size_t>(3 * p)]) * core::kFilmUnit / spp;
    sum += v;
    sum2 += v * v;
  }
  const double mean = sum / n, variance = std::max(0.0, sum2 / n - mean * mean);
  return {mean, std::sqrt(variance / (n - 1))};
}
inline Mean mean_radiance(const core::Scene& scene, const core::RenderSettings& settings, std::uint32_t spp,
                          int side_px = 4) {
  return mean_radiance(core::integrators::prepare(scene, settings, 2), settings, spp, side_px);
}

// The mean of such means of 8 x 8 pixels with different seeds, whose differences give its error.
inline Mean mean_of_seeds(const core::Scene& scene, core::RenderSettings settings, std::uint32_t spp,
                          int seeds = 8) {
  const core::integrators::RenderPlan plan = core::integrators::prepare(scene, settings, 2);
  double sum = 0, sum2 = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    settings.seed = static_cast<std::uint64_t>(seed);
    const double value = mean_radiance(plan, settings, spp, 8).value;
    sum += value;
    sum2 += value * value;
  }
  const double mean = sum / seeds;
  return {mean, std::sqrt(std::max(0.0, sum2 / seeds - mean * mean) / (seeds - 1))};
}

inline constexpr std::uint32_t kSampleDivisor = kEffortDivisor;
inline constexpr double kMaxNoise = kSampleDivisor == 1 ? 0.02 : 0.1;  // standard error over mean

// Every strategy finds `expected` with `spp` / kSampleDivisor samples. `naive` takes ten times as many.
inline void expect_radiance(const core::Scene& scene, double expected, std::uint32_t spp = 4000) {
  spp /= kSampleDivisor;
  for (const Strategy& strategy : kStrategies) {
    const bool naive = strategy.integrator == core::Integrator::kNaive;
    const Mean mean = mean_radiance(
        scene, {.integrator = strategy.integrator, .heuristic = strategy.heuristic}, naive ? 10 * spp : spp);
    EXPECT_NEAR(mean.value, expected, 5 * mean.standard_error + 1e-4 * expected) << strategy.name;
    EXPECT_LT(mean.standard_error, kMaxNoise * expected) << strategy.name << " is too noisy to tell";
  }
}

}  // namespace tessera::test
