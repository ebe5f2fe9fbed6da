// SPDX-License-Identifier: Apache-2.0
// Paths that are traced together do not know of each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <numeric>
#include <random>
#include <vector>

#include "core/integrators/fingerprint.hpp"
#include "core/integrators/path.hpp"
#include "tests/support/effort.hpp"

namespace tessera::core::integrators {
namespace {

// A path by its camera ray and its random numbers.
struct Start {
  Ray ray;
  sampling::Sampler sampler;
};

class PathBatch : public testing::TestWithParam<Integrator> {
 protected:
  explicit PathBatch(const SceneDescription& description = fingerprint_scene())
      : scene_(Scene::build(description, 1).value()), settings_(scene_.settings()) {
    settings_.integrator = GetParam();
    for (int y = 0; y < settings_.height_px; ++y)
      for (int x = 0; x < settings_.width_px; ++x)
        for (std::uint32_t s = 0; s < 8; ++s)
          starts_.push_back({scene_.camera().ray({static_cast<float>(x), static_cast<float>(y)},
                                                 settings_.width_px, settings_.height_px, {0.3f, 0.6f}),
                             sampling::Sampler(settings_.seed, x, y, s)});
  }

  // The radiance of starts_[order[i]], with up to `size` paths under way at once.
  std::vector<Rgb> trace(const std::vector<std::size_t>& order, std::size_t size) {
    std::vector<Rgb> found(size), radiance(order.size());
    std::vector<sampling::Sampler> samplers(size, sampling::Sampler(0, 0, 0, 0));
    const RenderPlan plan = plans_.get(settings_, 1);
    const auto tracer = std::make_unique<PathTracer>(plan, samplers, found);
    std::vector<std::size_t> serves(size);  // which of the order each path does
    std::vector<std::uint32_t> free(size);
    std::iota(free.begin(), free.end(), 0u);
    for (std::size_t next = 0; next < order.size() || free.size() < size;) {
      for (; next < order.size() && !free.empty(); ++next) {
        const std::uint32_t path = free.back();
        free.pop_back();
        serves[path] = next;
        samplers[path] = starts_[order[next]].sampler;
        const Ray& ray = starts_[order[next]].ray;
        tracer->begin({broadcast<FloatN>(ray.origin), broadcast<FloatN>(ray.direction)}, {&path, 1});
      }
      for (const std::uint32_t path : tracer->step(counters_)) {
        radiance[serves[path]] = found[path];
        free.push_back(path);
      }
    }
    return radiance;
  }

  Scene scene_;
  RenderPlans plans_{scene_};
  RenderSettings settings_;
  std::vector<Start> starts_;
  RenderCounters counters_;
};

TEST_P(PathBatch, OfAnySizeInAnyOrderGivesWhatEachPathGivesAlone) {
  std::vector<std::size_t> order(starts_.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const std::vector<Rgb> alone = trace(order, 1);
  const RenderCounters counters = counters_;
  ASSERT_GT(starts_.size(), 3 * kBatchPaths);  // at last some wait that are not of the next step
  std::mt19937 random(1);
  for (const std::size_t size :
       {std::size_t{2}, std::size_t{7}, std::size_t{64}, kBatchPaths, 3 * kBatchPaths}) {
    counters_ = {};
    const std::vector<Rgb> together = trace(order, size);
    for (std::size_t i = 0; i < order.size(); ++i)
      ASSERT_EQ(together[i], alone[order[i]]) << size << ' ' << i;
    ASSERT_EQ(counters_, counters);
    std::shuffle(order.begin(), order.end(), random);
  }
}

// A white ball around a mirror, seen from between them.
SceneDescription white_ball() {
  SceneDescription scene = fingerprint_scene();
  scene.materials = {{.name = "wall", .model = Lambert{{Rgb::gray(0.995f)}}, .emission = {0.1f, 0.1f, 0.1f}},
                     {.name = "mirror", .model = Mirror{}}};
  scene.textures = {};
  scene.objects = {};
  scene.shapes = {SphereDescription{{0, 1, 0}, 9, 0}, SphereDescription{{0, 1, 0}, 1, 1}};
  scene.lights = {};
  scene.environment = {};
  return scene;
}

// A closed mirror, which Russian roulette ends no path in.
SceneDescription mirror_ball() {
  SceneDescription scene = white_ball();
  scene.materials[0] = {.name = "wall", .model = Mirror{}};
  return scene;
}

class LongPaths : public PathBatch {
 protected:
  LongPaths() : PathBatch(white_ball()) {}
};

// Beyond some depth, paths of any number of vertices are traced together.
TEST_P(LongPaths, GiveWhatEachGivesAlone) {
  std::vector<std::size_t> order(
      std::max<std::size_t>(64, starts_.size() / 32 / tessera::test::kEffortDivisor));
  std::iota(order.begin(), order.end(), std::size_t{0});
  const std::vector<Rgb> alone = trace(order, 1);
  ASSERT_GT(counters_.closest_hit_rays, 100 * order.size()) << "paths are too short to tell";
  for (const std::size_t size : {std::size_t{50}, kBatchPaths}) {
    const std::vector<Rgb> together = trace(order, size);
    for (std::size_t i = 0; i < order.size(); ++i)
      ASSERT_EQ(together[i], alone[order[i]]) << size << ' ' << i;
  }
}

TEST_P(LongPaths, EndAtMaxDepthWhereverItIs) {
  std::vector<std::size_t> order(64);
  std::iota(order.begin(), order.end(), std::size_t{0});
  scene_ = Scene::build(mirror_ball(), 1).value();
  for (const int max_depth : {1, 63, 64, 65, 66, 1000, 0}) {
    settings_.max_depth = max_depth;
    counters_ = {};
    trace(order, order.size());
    const int vertices = 1 + (max_depth > 0 ? max_depth : kMaxPathDepth);
    EXPECT_EQ(counters_.closest_hit_rays, order.size() * static_cast<std::size_t>(vertices));
  }
}

INSTANTIATE_TEST_SUITE_P(Strategies, LongPaths,
                         testing::Values(Integrator::kNaive, Integrator::kNee, Integrator::kMis));
INSTANTIATE_TEST_SUITE_P(Strategies, PathBatch,
                         testing::Values(Integrator::kNaive, Integrator::kNee, Integrator::kMis));

}  // namespace
}  // namespace tessera::core::integrators
