// SPDX-License-Identifier: Apache-2.0
// Light samples through panes: the same expectation as of paths alone, with less noise.
#include "core/integrators/panes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

#include "core/integrators/render.hpp"
#include "tests/support/mean_radiance.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

// A sky whose upper half has a bright spot of four texels.
EnvironmentDescription sunny_sky(test::SceneMaker& maker, float brightness) {
  constexpr std::size_t kWidth = 64, kHeight = 32;
  std::vector<float> texels(3 * kWidth * kHeight, 0.2f);
  for (const std::size_t row : {8, 9})
    for (const std::size_t column : {20, 21})
      for (std::size_t c = 0; c < 3; ++c) texels[3 * (row * kWidth + column) + c] = brightness;
  maker.description().textures.push_back(
      {.image = std::make_shared<TextureImage>(TextureImage{kWidth, kHeight, std::move(texels)})});
  EnvironmentDescription sky{{Rgb::gray(1)}};
  sky.radiance.texture = 0;
  return sky;
}

// A floor under a tilted pane, with a ball of `ball` between them.
test::SceneMaker under_a_pane(const MaterialModel& pane, const MaterialModel& ball) {
  test::SceneMaker maker({.position = {0, 0.6f, 2.5f}, .look_at = {0, 0.1f, 0}, .vertical_fov_degrees = 40});
  const auto floor = maker.material(test::lambert(0.6f)), glass = maker.material(pane),
             body = maker.material(ball);
  maker.add(QuadDescription{{-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, floor});
  maker.add(QuadDescription{{-9, 1.6f, 9}, {18, 0.9f, 0}, {0, 0, -18}, glass});
  maker.add(QuadDescription{{-9, 1.5f, 9}, {0, 0, -18}, {18, 0.9f, 0}, glass});
  maker.add(SphereDescription{{0.4f, 0.4f, 0}, 0.4f, body});
  return maker;
}

Scene under_a_sunny_pane(float brightness, const MaterialModel& ball = test::lambert(0.4f)) {
  test::SceneMaker maker = under_a_pane(Glass{}, ball);
  maker.description().environment = sunny_sky(maker, brightness);
  return maker.build();
}

void expect_mean_of_paths(const Scene& scene, int max_depth) {
  const std::uint32_t spp = std::max(4u, 32 / test::kEffortDivisor);
  const test::Mean paths =
      test::mean_of_seeds(scene, {.integrator = Integrator::kNaive, .max_depth = max_depth}, 16 * spp);
  ASSERT_LT(paths.standard_error, 0.02 * test::kEffortDivisor * paths.value) << "too noisy to tell";
  for (const test::Strategy& strategy : test::kStrategies) {
    if (strategy.integrator == Integrator::kNaive) continue;
    const RenderSettings settings{
        .integrator = strategy.integrator, .heuristic = strategy.heuristic, .max_depth = max_depth};
    ASSERT_TRUE(prepare(scene, settings, 1).samples_through_panes());
    const test::Mean mean = test::mean_of_seeds(scene, settings, spp);
    EXPECT_NEAR(mean.value, paths.value, 5 * std::hypot(mean.standard_error, paths.standard_error))
        << strategy.name << ", depth " << max_depth;
  }
}

TEST(Panes, LightThroughThemHasTheMeanOfPathsAtEveryDepth) {
  const Scene scene = under_a_sunny_pane(60);
  for (const int max_depth : {0, 2, 3, 5}) expect_mean_of_paths(scene, max_depth);
}

// The ball focuses some of the light that has passed the pane, and is itself seen through.
TEST(Panes, LightThroughThemHasTheMeanOfPathsBesideOtherGlass) {
  expect_mean_of_paths(under_a_sunny_pane(60, Glass{}), 0);
  expect_mean_of_paths(under_a_sunny_pane(60, Mirror{{Rgb::gray(0.9f)}}), 0);
}

// A part of a blend is no pane.
TEST(Panes, LightThroughThemHasTheMeanOfPathsBesideBlendsOfGlass) {
  test::SceneMaker maker = under_a_pane(Glass{}, test::lambert(0.4f));
  const auto glass = maker.material(Glass{}), matt = maker.material(test::lambert(0.5f)),
             blend = maker.material(Blend{glass, matt, 0.3f});
  maker.add(QuadDescription{{-2, 1, 2}, {4, 0, 0}, {0, 0, -4}, blend});
  maker.add(QuadDescription{{-2, 0.95f, 2}, {0, 0, -4}, {4, 0, 0}, blend});
  maker.description().environment = sunny_sky(maker, 60);
  expect_mean_of_paths(maker.build(), 0);
}

TEST(Panes, HaveNoNoiseOfASmallSun) {
  const Scene scene = under_a_sunny_pane(5000);
  const test::Mean mean = test::mean_of_seeds(scene, {}, std::max(4u, 64 / test::kEffortDivisor));
  EXPECT_LT(mean.standard_error, 0.005 * test::kEffortDivisor * mean.value);
}

// Glass that neither absorbs nor adds light cannot be seen in an even environment.
TEST(Panes, AreInvisibleInAWhiteFurnace) {
  test::SceneMaker maker = under_a_pane(Glass{}, test::lambert(1));
  maker.description().materials[0].model = test::lambert(1);
  maker.description().environment = EnvironmentDescription{{Rgb::gray(1)}};
  const Scene scene = maker.build();
  ASSERT_TRUE(prepare(scene, {}, 1).samples_through_panes());
  test::expect_radiance(scene, 1, 400);
}

TEST(Panes, DoNotDependOnHowARenderIsCut) {
  const Scene scene = under_a_sunny_pane(500, Glass{});
  const RenderSettings settings{.width_px = 24, .height_px = 16, .spp = 8};
  const RenderPlan plan = prepare(scene, settings, 2);
  const FilmTile whole = render(plan, {0, 0, 24, 16}, {0, 8}, 1);
  EXPECT_EQ(render(prepare(scene, settings, 1), {0, 0, 24, 16}, {0, 8}, 3).sums, whole.sums);
  const FilmTile piece = render(plan, {5, 3, 6, 4}, {0, 8}, 1);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(piece.sums[c], whole.sums[3 * (3 * 24 + 5) + c]);
}

TEST(Panes, AreParallelSurfacesOfPlainGlassBeforeTheEnvironment) {
  const auto found_in = [](const Scene& scene) { return prepare(scene, {}, 1).samples_through_panes(); };
  EXPECT_FALSE(found_in(Scene::build(test::room(), 1).value())) << "no environment";
  const auto with_pane = [&](const MaterialModel& pane) {
    test::SceneMaker maker = under_a_pane(pane, test::lambert(0.5f));
    maker.description().environment = sunny_sky(maker, 50);
    return found_in(maker.build());
  };
  EXPECT_TRUE(with_pane(Glass{}));
  EXPECT_FALSE(with_pane(Glass{.roughness = 0.3f}));
  EXPECT_FALSE(with_pane(Mirror{{Rgb::gray(0.9f)}}));
}

}  // namespace
}  // namespace tessera::core::integrators
