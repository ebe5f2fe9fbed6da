// SPDX-License-Identifier: Apache-2.0
#include "tests/statistical/agreement.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/integrators/render.hpp"
#include "core/integrators/render_plan.hpp"

namespace tessera::test {
namespace {

using namespace core;

constexpr int kRegionsAcross = 4, kRegionPx = 6, kSidePx = kRegionsAcross * kRegionPx;
constexpr int kRegions = kRegionsAcross * kRegionsAcross;
constexpr int kBatches = 24;  // independent renders, whose spread tells the error of their mean

struct Estimate {
  double mean = 0, variance_of_mean = 0;
};

std::vector<double> region_means(const core::integrators::RenderPlan& plan) {
  const std::uint32_t spp = plan.settings().spp;
  const FilmTile tile = render(plan, {0, 0, kSidePx, kSidePx}, {0, spp}, 2);
  std::vector<double> means(kRegions);
  for (int y = 0; y < kSidePx; ++y)
    for (int x = 0; x < kSidePx; ++x)
      for (int c = 0; c < 3; ++c) {
        const auto i = static_cast<std::size_t>(3 * (y * kSidePx + x) + c);
        means[static_cast<std::size_t>(y / kRegionPx * kRegionsAcross + x / kRegionPx)] +=
            static_cast<double>(tile.sums[i]) * kFilmUnit / spp / (3 * kRegionPx * kRegionPx);
      }
  return means;
}

// The seeds are `first_seed` and every fourth after it.
std::vector<Estimate> estimate(core::integrators::RenderPlans& plans, RenderSettings settings,
                               std::uint64_t first_seed) {
  settings.width_px = settings.height_px = kSidePx;
  const core::integrators::RenderPlan plan = plans.get(settings, 2);
  std::vector<double> sum(kRegions), sum2(kRegions);
  for (int batch = 0; batch < kBatches; ++batch) {
    settings.seed = static_cast<std::uint64_t>(batch) * 4 + first_seed;
    const auto means = region_means(plan.with(settings));
    for (std::size_t r = 0; r < kRegions; ++r) {
      sum[r] += means[r];
      sum2[r] += means[r] * means[r];
    }
  }
  std::vector<Estimate> estimates(kRegions);
  for (std::size_t r = 0; r < kRegions; ++r) {
    const double mean = sum[r] / kBatches;
    estimates[r] = {mean, std::max(0.0, sum2[r] / kBatches - mean * mean) / (kBatches - 1)};
  }
  return estimates;
}

// Welch's test of each region. With 24 batches, |t| > 5.5 happens by chance less than once in 10^5 regions.
void expect_agreement(const std::vector<Estimate>& a, const std::vector<Estimate>& b,
                      const std::string& names) {
  constexpr double kMaxT = 5.5;
  for (std::size_t r = 0; r < kRegions; ++r) {
    const double error = std::sqrt(a[r].variance_of_mean + b[r].variance_of_mean);
    EXPECT_LE(std::fabs(a[r].mean - b[r].mean), kMaxT * error + 1e-5 * a[r].mean)
        << names << " in region " << r << ": " << a[r].mean << " and " << b[r].mean;
  }
}

}  // namespace

void expect_strategies_agree(SceneDescription description) {
  description.settings.max_depth = 0;
  const auto scene = Scene::build(std::move(description), 2);
  ASSERT_TRUE(scene) << scene.error().message;
  core::integrators::RenderPlans plans(*scene);
  // Noisier strategies get more samples, so that a difference can show. In a medium, naive
  // paths are little noisier than the others, and samples take ten times as long.
  const bool in_medium = scene->camera_medium() != kNoMedium;
  const std::uint32_t spp = in_medium ? 32 : 64, naive_spp = in_medium ? 32 : 256;
  const auto mis = estimate(plans, {.spp = spp, .integrator = Integrator::kMis}, 2);
  const auto nee = estimate(plans, {.spp = spp, .integrator = Integrator::kNee}, 1);
  const auto naive = estimate(plans, {.spp = naive_spp, .integrator = Integrator::kNaive}, 0);
  const auto power =
      estimate(plans, {.spp = spp, .integrator = Integrator::kMis, .heuristic = Heuristic::kPower}, 3);
  expect_agreement(mis, nee, "mis and nee");
  expect_agreement(mis, naive, "mis and naive");
  expect_agreement(mis, power, "mis by the balance and by the power heuristic");
}

void expect_scenes_agree(SceneDescription a, SceneDescription b) {
  const auto scene_a = Scene::build(std::move(a), 2), scene_b = Scene::build(std::move(b), 2);
  ASSERT_TRUE(scene_a) << scene_a.error().message;
  ASSERT_TRUE(scene_b) << scene_b.error().message;
  core::integrators::RenderPlans plans_a(*scene_a), plans_b(*scene_b);
  expect_agreement(estimate(plans_a, {.spp = 64}, 0), estimate(plans_b, {.spp = 64}, 1), "the two scenes");
}

}  // namespace tessera::test
