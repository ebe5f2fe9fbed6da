// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/whitted.hpp"

#include <gtest/gtest.h>
#include <numbers>

#include <cmath>
#include <memory>
#include <vector>

#include "tests/support/mean_radiance.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

double whitted(const Scene& scene, int max_depth = 0, std::uint32_t spp = 4) {
  return test::mean_radiance(scene, {.integrator = Integrator::kWhitted, .max_depth = max_depth}, spp).value;
}

CameraDescription looking_down() {
  return {.position = {2, 3, 1}, .look_at = {0, 0, 0}, .up = {0, 1, 0.1f}, .vertical_fov_degrees = 0.01f};
}

CameraDescription looking_ahead(float distance) {
  return {.position = {0, 0, distance}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 0.5f};
}

QuadDescription upright(float z, std::uint32_t material) {
  return {{-5, -5, z}, {10, 0, 0}, {0, 10, 0}, material};
}

// Each sample is exact: nothing about it is random.
TEST(Whitted, LightsADiffuseSurfaceOnceFromEachLight) {
  test::SceneMaker maker(looking_down());
  maker.add(QuadDescription{{-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, maker.material(test::lambert(0.6f))});
  maker.description().lights = {PointLightDescription{{0, 2, 0}, Rgb::gray(8)},
                                SpotLightDescription{{0, 1, 0}, {0, 0, 0}, Rgb::gray(3)},
                                DirectionalLightDescription{{3, -4, 0}, Rgb::gray(5)}};
  EXPECT_NEAR(whitted(maker.build(), 0, 1), 0.6 / std::numbers::pi * (8.0 / 4 + 3 + 5 * 0.8), 1e-4);
}

TEST(Whitted, CastsShadows) {
  test::SceneMaker maker(looking_down());
  const auto white = maker.material(test::lambert(0.6f));
  maker.add(QuadDescription{{-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, white});
  maker.add(QuadDescription{{-0.1f, 1, -0.1f}, {0.2f, 0, 0}, {0, 0, 0.2f}, white});
  maker.description().lights = {PointLightDescription{{0, 2, 0}, Rgb::gray(8)}};
  EXPECT_EQ(whitted(maker.build()), 0);
  maker.description().lights = {PointLightDescription{{0, 0.9f, 0}, Rgb::gray(8)}};
  EXPECT_GT(whitted(maker.build()), 0);
}

TEST(Whitted, SamplesAreaLightsAndSurroundings) {
  test::SceneMaker maker(looking_down());
  maker.add(QuadDescription{{-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, maker.material(test::lambert(0.5f))});
  maker.add(SphereDescription{{0, 1.5f, 0}, 0.3f, maker.material(test::lambert(0), Rgb::gray(8))});
  maker.description().environment = {{Rgb::gray(2)}};
  EXPECT_NEAR(whitted(maker.build(), 0, 4000), 0.5 * (8 * 0.04 + 2 * (1 - 0.04)), 2e-3);
}

TEST(Whitted, SamplesSomeOfManyLights) {
  test::SceneMaker maker(looking_down());
  maker.add(QuadDescription{{-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, maker.material(test::lambert(0.6f))});
  double irradiance = 0;
  for (int i = 0; i < 50; ++i) {
    const float height = 1 + 0.1f * static_cast<float>(i), intensity = static_cast<float>(1 + i % 7);
    maker.description().lights.push_back(PointLightDescription{{0, height, 0}, Rgb::gray(intensity)});
    irradiance += static_cast<double>(intensity / (height * height));
  }
  const Scene scene = maker.build();
  EXPECT_NEAR(whitted(scene, 0, 2000), 0.6 / std::numbers::pi * irradiance, 2e-3 * irradiance);
  const RenderSettings settings{.width_px = 4, .height_px = 4, .integrator = Integrator::kWhitted};
  EXPECT_EQ(render(prepare(scene, settings, 1), {0, 0, 4, 4}, {0, 1}, 1).counters.shadow_rays,
            16 * kMaxWhittedLights);
}

TEST(Whitted, LeavesOutLightThatIsScatteredTwice) {
  test::SceneMaker maker(looking_down());
  const auto white = maker.material(test::lambert(0.6f));
  maker.add(QuadDescription{{-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, white});
  maker.add(QuadDescription{{-1, 0, -1}, {2, 0, 0}, {0, 2, 0}, white});
  maker.description().lights = {PointLightDescription{{0, 2, 0}, Rgb::gray(8)}};
  const Scene scene = maker.build();
  EXPECT_NEAR(whitted(scene), 0.6 / std::numbers::pi * 2, 1e-4);
  EXPECT_GT(test::mean_radiance(scene, {}, 200).value, 1.02 * 0.6 / std::numbers::pi * 2);
}

TEST(Whitted, MirrorsShowWhatIsBeforeThem) {
  test::SceneMaker maker(looking_ahead(3));
  maker.add(upright(0, maker.material(Mirror{{Rgb::gray(0.7f)}})));
  maker.description().environment = {{Rgb::gray(2)}};
  EXPECT_NEAR(whitted(maker.build()), 1.4, 1e-5);
  maker.add(upright(5, maker.material(test::lambert(0), Rgb::gray(10))));
  EXPECT_NEAR(whitted(maker.build()), 7, 1e-5);
}

// Between two mirrors that also emit: Le (1 + R + R^2 + ...), as far as the depth allows.
TEST(Whitted, FollowsReflectionsToTheDepthLimit) {
  test::SceneMaker maker(looking_ahead(0.5f));
  const auto emissive_mirror = maker.material(Mirror{{Rgb::gray(0.8f)}}, Rgb::gray(1));
  maker.add(upright(-1, emissive_mirror));
  maker.add(upright(1, emissive_mirror));
  const Scene scene = maker.build();
  const auto sum = [](int reflections) { return (1 - std::pow(0.8, reflections + 1)) / 0.2; };
  for (const int depth : {1, 2, 5, 20}) EXPECT_NEAR(whitted(scene, depth), sum(depth), 1e-4) << depth;
  EXPECT_NEAR(whitted(scene, 0), sum(kWhittedDepth), 1e-4);
  EXPECT_NEAR(whitted(scene, 1000), 5, 0.01) << "ends where too little is left";
}

// Surfaces that split light and give off more than they receive, as by bright textures: twice as many rays at
// each depth.
TEST(Whitted, EndsATreeThatGrowsWithoutEnd) {
  test::SceneMaker maker(looking_ahead(0.5f));
  // Only textures can reflect more than they receive.
  maker.description().textures = {
      {.image = std::make_shared<TextureImage>(1, 1, std::vector<float>{1, 1, 1})}};
  const auto glass =
      maker.material(Glass{.ior = 4, .reflectance = {Rgb::gray(8), 0}, .transmittance = {Rgb::gray(8), 0}});
  for (const float z : {-1.0f, 1.0f}) maker.add(upright(z, glass));
  maker.add(upright(-2, maker.material(Mirror{})));
  maker.add(upright(2, maker.material(Mirror{})));
  const RenderSettings settings{
      .width_px = 1, .height_px = 1, .integrator = Integrator::kWhitted, .max_depth = kMaxDepth};
  EXPECT_EQ(render(prepare(maker.build(), settings, 1), {0, 0, 1, 1}, {0, 1}, 1).counters.closest_hit_rays,
            static_cast<std::uint64_t>(kMaxWhittedRays));
}

// Through a slab of glass: T^2 + T^2 R^2 + ..., each term two surfaces deeper than the last.
TEST(Whitted, FollowsBothBranchesAtGlass) {
  test::SceneMaker maker(looking_ahead(3));
  const auto glass = maker.material(Glass{.ior = 1.5f});
  maker.add(QuadDescription{{-5, -5, 0.1f}, {10, 0, 0}, {0, 10, 0}, glass});
  maker.add(QuadDescription{{-5, -5, -0.1f}, {0, 10, 0}, {10, 0, 0}, glass});
  maker.add(upright(-2, maker.material(test::lambert(0), Rgb::gray(3))));
  const Scene scene = maker.build();
  const double r = 0.04, t = 0.96;
  EXPECT_EQ(whitted(scene, 1), 0);
  EXPECT_NEAR(whitted(scene, 2), 3 * t * t, 1e-4);
  EXPECT_NEAR(whitted(scene, 3), 3 * t * t, 1e-4);
  EXPECT_NEAR(whitted(scene, 4), 3 * t * t * (1 + r * r), 1e-4);
  // From before it: R from the first surface, T^2 R from the second.
  maker.add(upright(4, maker.material(test::lambert(0), Rgb::gray(5))));
  EXPECT_NEAR(whitted(maker.build(), 3), 3 * t * t + 5 * (r + t * t * r), 1e-4);
}

// What is reflected and what is refracted add up to all of the light, also with total reflection inside.
TEST(Whitted, GlassIsNearlyInvisibleInUniformSurroundings) {
  test::SceneMaker maker({.position = {0, 0, 4}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 30});
  maker.add(SphereDescription{{0, 0, 0}, 1, maker.material(Glass{.ior = 1.5f})});
  maker.description().environment = {{Rgb::gray(3)}};
  const double seen = whitted(maker.build(), 30, 64);
  EXPECT_LE(seen, 3 + 1e-5);
  EXPECT_GT(seen, 3 * 0.999);
}

}  // namespace
}  // namespace tessera::core::integrators
