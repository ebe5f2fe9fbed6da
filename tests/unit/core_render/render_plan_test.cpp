// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/render_plan.hpp"

#include <gtest/gtest.h>

#include "core/integrators/render.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

constexpr PixelRect kPlanWindow{8, 8, 24, 16};
constexpr SampleRange kPlanSamples{0, 3};

RenderSettings settings_with(const Scene& scene, Integrator integrator, std::uint64_t seed = 0) {
  RenderSettings settings = scene.settings();
  settings.integrator = integrator;
  settings.seed = seed;
  return settings;
}

SceneDescription room_seen_in_passing() {
  SceneDescription room = test::room();
  room.animation.camera.position = {{0, 4}, {room.camera.position, room.camera.position * 0.9f}};
  return room;
}

TEST(RenderPlan, IsPreparedOnceForSettingsWithTheSameIntegrator) {
  const Scene scene = Scene::build(test::room(), 1).value();
  RenderPlans plans(scene);
  const RenderPlan one = plans.get(settings_with(scene, Integrator::kMis, 1), 1);
  const RenderPlan other = plans.get(settings_with(scene, Integrator::kMis, 2), 1);
  ASSERT_NE(one.guide(), nullptr);
  EXPECT_EQ(other.guide(), one.guide());
  EXPECT_EQ(&other.light_sampler(), &one.light_sampler());
  EXPECT_EQ(one.settings().seed, 1u);
  EXPECT_EQ(other.settings().seed, 2u);
  EXPECT_NE(&plans.get(settings_with(scene, Integrator::kNee), 1).light_sampler(), &one.light_sampler());
}

TEST(RenderPlan, RendersAsOneThatWasPreparedForItsSettings) {
  const Scene scene = Scene::build(test::room(), 1).value();
  RenderPlans plans(scene);
  for (const Integrator integrator :
       {Integrator::kMis, Integrator::kWhitted, Integrator::kNaive, Integrator::kNee, Integrator::kMis}) {
    for (const std::uint64_t seed : {1u, 2u}) {
      const RenderSettings settings = settings_with(scene, integrator, seed);
      EXPECT_EQ(render(plans.get(settings, 2), kPlanWindow, kPlanSamples, 1).sums,
                render(prepare(scene, settings, 1), kPlanWindow, kPlanSamples, 1).sums)
          << integrator_name(integrator);
    }
  }
}

TEST(RenderPlan, ConnectsNaivePathsOnlyToLightsThatNoRayHits) {
  SceneDescription room = test::room();
  room.lights = {PointLightDescription{{0, 1, 0}, Rgb::gray(1)}};
  const Scene scene = Scene::build(room, 1).value();
  const std::size_t lights = scene.lights().size();
  ASSERT_GT(lights, 1u);
  EXPECT_EQ(prepare(scene, settings_with(scene, Integrator::kNaive), 1).light_sampler().size(), 1u);
  EXPECT_EQ(prepare(scene, settings_with(scene, Integrator::kNee), 1).light_sampler().size(), lights);
}

TEST(RenderPlan, IsRebuiltForAnotherFrame) {
  Scene scene = Scene::build(room_seen_in_passing(), 1).value();
  RenderPlans plans(scene);
  const RenderSettings settings = settings_with(scene, Integrator::kNee);
  const RenderPlan first = plans.get(settings, 1);
  ASSERT_TRUE(scene.set_frame(0, 1));
  EXPECT_TRUE(first.is_current()) << "the frame that it shows already";
  ASSERT_TRUE(scene.set_frame(4, 1));
  EXPECT_FALSE(first.is_current());
  const RenderPlan second = plans.get(settings, 1);
  EXPECT_TRUE(second.is_current());
  EXPECT_NE(&second.light_sampler(), &first.light_sampler());
}

TEST(RenderPlan, LastsForAllFramesOfAStillScene) {
  Scene scene = Scene::build(test::room(), 1).value();
  const RenderPlan plan = prepare(scene, settings_with(scene, Integrator::kNaive), 1);
  ASSERT_TRUE(scene.set_frame(7, 1));
  EXPECT_TRUE(plan.is_current());
}

}  // namespace
}  // namespace tessera::core::integrators
