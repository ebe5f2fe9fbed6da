// SPDX-License-Identifier: Apache-2.0
// Light samples that know the openings through which the environment lights a room.
#include "core/integrators/environment_guide.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "core/integrators/render.hpp"
#include "core/sampling/sampler.hpp"
#include "tests/support/mean_radiance.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

constexpr Vec3 kUp{0, 1, 0};
// The middle of the opening of room_with_opening().
constexpr Vec3 kOpening{-2, 1.5f, 0};

// A room of 4 x 3 x 4, whose left wall has an opening of 1 x 1.
test::SceneMaker room_with_opening() {
  test::SceneMaker maker(
      {.position = {1.8f, 1.5f, 1.8f}, .look_at = {-1, 0.8f, -1}, .vertical_fov_degrees = 60});
  const auto wall = maker.material(test::lambert(0.6f)), ball = maker.material(test::lambert(0.4f));
  maker.add(QuadDescription{{-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, wall});     // floor
  maker.add(QuadDescription{{-2, 3, 2}, {0, 0, -4}, {4, 0, 0}, wall});     // ceiling
  maker.add(QuadDescription{{-2, 0, -2}, {4, 0, 0}, {0, 3, 0}, wall});     // back
  maker.add(QuadDescription{{2, 0, 2}, {-4, 0, 0}, {0, 3, 0}, wall});      // front
  maker.add(QuadDescription{{2, 0, 2}, {0, 3, 0}, {0, 0, -4}, wall});      // right
  maker.add(QuadDescription{{-2, 0, 2}, {0, 0, -4}, {0, 1, 0}, wall});     // left: below the opening,
  maker.add(QuadDescription{{-2, 2, 2}, {0, 0, -4}, {0, 1, 0}, wall});     // above it,
  maker.add(QuadDescription{{-2, 1, 2}, {0, 0, -1.5f}, {0, 1, 0}, wall});  // and on both sides
  maker.add(QuadDescription{{-2, 1, -0.5f}, {0, 0, -1.5f}, {0, 1, 0}, wall});
  maker.add(SphereDescription{{0, 0.5f, -0.8f}, 0.5f, ball});
  maker.description().environment = EnvironmentDescription{{{5, 6, 8}}};
  return maker;
}

// Large enough for paths to find it.
void add_lamp(test::SceneMaker& maker) {
  const auto lamp = maker.material(test::lambert(0), {1, 1, 0.9f}, false);
  maker.add(QuadDescription{{-1.5f, 2.9f, 1.5f}, {0, 0, -3}, {3, 0, 0}, lamp});
}

// A sky with a small sun that lights the floor through the opening.
void add_sun(test::SceneMaker& maker) {
  constexpr std::size_t kWidth = 256, kHeight = 128;
  const auto index_of = [](float part, std::size_t size) {
    return static_cast<std::size_t>(part * static_cast<float>(size));
  };
  std::vector<float> texels(3 * kWidth * kHeight, 4.0f);
  const Vec2 sun = lights::EquirectangularMap(0).uv_of(kOpening - Vec3{0.2f, 0, 0.3f});
  const std::size_t texel = index_of(sun.y, kHeight) * kWidth + index_of(sun.x, kWidth);
  for (std::size_t c = 0; c < 3; ++c) texels[3 * texel + c] = 2e5f;
  maker.description().textures.push_back(
      {.image = std::make_shared<TextureImage>(TextureImage{kWidth, kHeight, std::move(texels)})});
  maker.description().environment = EnvironmentDescription{{Rgb::gray(1)}};
  maker.description().environment->radiance.texture = 0;
}

// A sheet of glass before the opening.
void add_pane(test::SceneMaker& maker) {
  const auto glass = maker.material(Glass{});
  maker.add(QuadDescription{{-2.1f, 0.9f, 0.6f}, {0, 0, -1.2f}, {0, 1.2f, 0}, glass});
  maker.add(QuadDescription{{-2.12f, 0.9f, 0.6f}, {0, 1.2f, 0}, {0, 0, -1.2f}, glass});
}

bool has_guide(const Scene& scene, Integrator integrator = Integrator::kMis) {
  return prepare(scene, {.integrator = integrator}, 1).environment_guide() != nullptr;
}

TEST(EnvironmentGuide, KnowsTheDirectionsOfAnOpening) {
  const Scene scene = room_with_opening().build();
  const RenderPlan plan = prepare(scene, {}, 1);
  const EnvironmentGuide* const guide = plan.environment_guide();
  ASSERT_NE(guide, nullptr);
  for (const Vec3 place : {Vec3{0.5f, 0, 0.5f}, Vec3{-1, 0, 1}, Vec3{1, 0, 1.5f}}) {
    const auto guidance = guide->at<float>({place, kUp});
    ASSERT_GT(guidance.share, 0);
    const auto pdf = [&](Vec3 wi) { return guide->sample_or(guidance, false, {}, wi).pdf; };
    EXPECT_GT(pdf(normalize(kOpening - place)), 20 * pdf(normalize(Vec3{2, 1.5f, 0} - place)));
    int open = 0;
    constexpr int kSamples = 1000;
    for (std::uint32_t i = 0; i < kSamples; ++i) {
      const auto u = sampling::Sampler(1, 0, 0, i).pad(0);
      const Vec3 wi = guide->sample_or(guidance, true, {u[0], u[1]}, kUp).direction;
      open += scene.closest_hit(Ray{place + kUp * 1e-4f, wi}).found() ? 0 : 1;
    }
    EXPECT_GT(open, kSamples / 2);
  }
}

TEST(EnvironmentGuide, IsNoneForSurfacesThatAreLitFromAllSides) {
  const Scene scene = room_with_opening().build();
  const RenderPlan plan = prepare(scene, {}, 1);
  EXPECT_EQ(plan.environment_guide()->at<float>({{0.5f, 0, 0.5f}, {}}).share, 0);
}

TEST(EnvironmentGuide, IsOfUseOnlyThroughOpeningsAndForLightSamples) {
  const Scene room = room_with_opening().build();
  EXPECT_TRUE(has_guide(room));
  EXPECT_TRUE(has_guide(room, Integrator::kNee));
  EXPECT_FALSE(has_guide(room, Integrator::kNaive));
  EXPECT_FALSE(has_guide(room, Integrator::kWhitted));

  test::SceneMaker dark = room_with_opening();
  dark.description().environment.reset();
  add_lamp(dark);
  EXPECT_FALSE(has_guide(dark.build())) << "no environment";
  test::SceneMaker closed = room_with_opening();
  closed.add(QuadDescription{{-2, 1, 0.5f}, {0, 0, -1}, {0, 1, 0}, 0});
  EXPECT_FALSE(has_guide(closed.build())) << "no opening";
  test::SceneMaker open = room_with_opening();
  open.description().shapes.erase(open.description().shapes.begin() + 1, open.description().shapes.end() - 1);
  EXPECT_FALSE(has_guide(open.build())) << "nothing but a floor and a ball";
}

constexpr std::uint32_t kSpp = std::max(4u, 16 / test::kEffortDivisor);

// All strategies find in the scene what `paths` have found.
void expect_mean(const Scene& scene, const test::Mean& paths, int max_depth) {
  ASSERT_LT(paths.standard_error, 0.02 * test::kEffortDivisor * paths.value) << "too noisy to tell";
  for (const test::Strategy& strategy : test::kStrategies) {
    if (strategy.integrator == Integrator::kNaive) continue;
    ASSERT_TRUE(has_guide(scene, strategy.integrator));
    const test::Mean mean = test::mean_of_seeds(
        scene, {.integrator = strategy.integrator, .heuristic = strategy.heuristic, .max_depth = max_depth},
        2 * kSpp);
    EXPECT_NEAR(mean.value, paths.value, 5 * std::hypot(mean.standard_error, paths.standard_error))
        << strategy.name << ", depth " << max_depth;
  }
}

void expect_mean_of_paths(const Scene& scene, int max_depth = 0) {
  const RenderSettings paths{.integrator = Integrator::kNaive, .max_depth = max_depth};
  expect_mean(scene, test::mean_of_seeds(scene, paths, 32 * kSpp), max_depth);
}

TEST(EnvironmentGuide, LeavesTheMeanThatOfPaths) {
  expect_mean_of_paths(room_with_opening().build());
  expect_mean_of_paths(room_with_opening().build(), 1);
}

TEST(EnvironmentGuide, LeavesTheMeanThatOfPathsBesideOtherLight) {
  test::SceneMaker maker = room_with_opening();
  add_lamp(maker);
  maker.description().lights = {DirectionalLightDescription{{1, -0.6f, 0.2f}, Rgb::gray(2)}};
  expect_mean_of_paths(maker.build());
}

TEST(EnvironmentGuide, LeavesTheMeanThatOfPathsThroughACurtain) {
  test::SceneMaker maker = room_with_opening();
  const auto curtain = maker.material(test::lambert(0.5f));
  maker.description().materials[curtain].opacity.value = 0.4f;
  maker.add(QuadDescription{{-1.9f, 0.9f, 0.6f}, {0, 0, -1.2f}, {0, 1.2f, 0}, curtain});
  maker.description().environment->visible_to_camera = false;
  expect_mean_of_paths(maker.build());
}

// The guide is learnt for one time; the shutter before the opening is elsewhere at others.
TEST(EnvironmentGuide, LeavesTheMeanThatOfPathsPastAMovingInstance) {
  test::SceneMaker maker = room_with_opening();
  SceneDescription& scene = maker.description();
  scene.objects = {{"shutter", {QuadDescription{{-1.9f, 0.9f, 0.6f}, {0, 0, -1.2f}, {0, 1.2f, 0}, 0}}, {}}};
  maker.add(InstanceDescription{0, {}, std::nullopt});
  const auto shutter = static_cast<std::uint32_t>(scene.shapes.size() - 1);
  scene.animation.instances = {{shutter, {TranslationMotion{{{0, 1}, {{0, 0, 0}, {0, 1.4f, 0}}}}}}};
  scene.camera.shutter_close = 1;
  expect_mean_of_paths(maker.build());
}

TEST(EnvironmentGuide, IsFiniteInLargeScenes) {
  test::SceneMaker maker = room_with_opening();
  constexpr float kScale = 1e14f;
  CameraDescription& camera = maker.description().camera;
  camera.position = camera.position * kScale;
  camera.look_at = camera.look_at * kScale;
  for (ShapeDescription& shape : maker.description().shapes) {
    if (auto* quad = std::get_if<QuadDescription>(&shape))
      *quad = {quad->corner * kScale, quad->edge_u * kScale, quad->edge_v * kScale, quad->material};
    else if (auto* sphere = std::get_if<SphereDescription>(&shape))
      *sphere = {sphere->center * kScale, sphere->radius * kScale, sphere->material};
  }
  const RenderSettings settings{.width_px = 16, .height_px = 16, .spp = 8};
  const Scene scene = maker.build();
  ASSERT_TRUE(has_guide(scene));
  EXPECT_EQ(render(prepare(scene, settings, 1), {0, 0, 16, 16}, {0, 8}, 1).counters.non_finite_samples, 0u);
}

// What is too bright to be added is not learnt; shares are numbers.
TEST(EnvironmentGuide, HasSharesUnderABlindingSky) {
  for (const float radiance : {1e30f, 1e37f}) {
    test::SceneMaker maker = room_with_opening();
    add_lamp(maker);
    maker.description().environment = EnvironmentDescription{{Rgb::gray(radiance)}};
    const Scene scene = maker.build();
    const RenderPlan plan = prepare(scene, {}, 1);
    if (plan.environment_guide() == nullptr) continue;
    for (const Vec3 place : {Vec3{0.5f, 0, 0.5f}, Vec3{-1, 0, 1}, Vec3{1, 0, 1.5f}})
      EXPECT_GE(plan.environment_guide()->at<float>({place, kUp}).share, 0);
  }
}

// Paths alone do not find the sun. In a scene with a medium, here outside the room, there is no guide.
TEST(EnvironmentGuide, LeavesTheMeanThatOfUnguidedLightSamplesUnderASun) {
  test::SceneMaker maker = room_with_opening();
  add_sun(maker);
  const Scene scene = maker.build();
  maker.description().media = {{.sigma_a = Rgb::gray(1)}};
  const auto haze = maker.material(test::lambert(0.5f));
  maker.description().materials[haze].media.interior = 0;
  maker.add(SphereDescription{{9, -9, 9}, 0.1f, haze});
  const Scene unguided = maker.build();
  ASSERT_FALSE(has_guide(unguided));
  expect_mean(scene, test::mean_of_seeds(unguided, {.max_depth = 2}, 4 * kSpp), 2);
}

TEST(EnvironmentGuide, LeavesTheMeanThatOfPathsThroughAPane) {
  test::SceneMaker maker = room_with_opening();
  add_pane(maker);
  const Scene scene = maker.build();
  ASSERT_TRUE(prepare(scene, {}, 1).samples_through_panes());
  expect_mean_of_paths(scene);
}

TEST(EnvironmentGuide, DoesNotDependOnThreadsOrOnHowARenderIsCut) {
  test::SceneMaker maker = room_with_opening();
  add_lamp(maker);
  const Scene scene = maker.build();
  const RenderSettings settings{.width_px = 24, .height_px = 16, .spp = 8};
  const RenderPlan plan = prepare(scene, settings, 3);
  ASSERT_NE(plan.environment_guide(), nullptr);
  const FilmTile whole = render(plan, {0, 0, 24, 16}, {0, 8}, 1);
  EXPECT_EQ(render(prepare(scene, settings, 1), {0, 0, 24, 16}, {0, 8}, 3).sums, whole.sums);
  const FilmTile piece = render(plan, {5, 3, 6, 4}, {0, 8}, 1);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(piece.sums[c], whole.sums[3 * (3 * 24 + 5) + c]);
}

}  // namespace
}  // namespace tessera::core::integrators
