// SPDX-License-Identifier: Apache-2.0
// Layered surfaces in the integrators: delta lobes among others, blends, media of solids, and nothing.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/mean_radiance.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

// A ball that fills the view, under an even sky of radiance 1.
test::SceneMaker ball_under_sky() {
  test::SceneMaker maker({.position = {0, 0, 4}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 10});
  maker.description().environment = EnvironmentDescription{{Rgb::gray(1)}};
  return maker;
}

void add_ball(test::SceneMaker& maker, std::uint32_t material) {
  maker.add(SphereDescription{{0, 0, 0}, 1, material});
}

void expect_in_all_integrators(const test::SceneMaker& maker, double expected, double tolerance) {
  const Scene scene = maker.build();
  for (const test::Strategy& strategy : test::kStrategies) {
    const auto mean = test::mean_radiance(scene, {.integrator = strategy.integrator}, 400);
    EXPECT_NEAR(mean.value, expected, tolerance + 5 * mean.standard_error) << strategy.name;
  }
  const auto whitted = test::mean_radiance(scene, {.integrator = Integrator::kWhitted}, 400);
  EXPECT_NEAR(whitted.value, expected, tolerance + 5 * whitted.standard_error);
}

TEST(LayeredSurface, WithASmoothCoatIsSeenByAllIntegrators) {
  auto maker = ball_under_sky();
  Principled model;
  model.base_color.value = Rgb::gray(1);
  model.coat_weight = 1;
  add_ball(maker, maker.material(model));
  expect_in_all_integrators(maker, 1, 0.006);
}

TEST(LayeredSurface, OfABlendReflectsTheMean) {
  auto maker = ball_under_sky();
  const auto first = maker.material(test::lambert(0.8f)), second = maker.material(Mirror{{Rgb::gray(0.4f)}});
  add_ball(maker, maker.material(Blend{.first = first, .second = second, .weight = 0.25f}));
  expect_in_all_integrators(maker, 0.75 * 0.8 + 0.25 * 0.4, 1e-3);
}

// Half of the rays that hit go through the front and the back.
TEST(LayeredSurface, OfABlendWithNothingIsACutOut) {
  auto maker = ball_under_sky();
  const auto black = maker.material(test::lambert(0)), nothing = maker.material(Null{});
  add_ball(maker, maker.material(Blend{.first = black, .second = nothing, .weight = 0.5f}));
  expect_in_all_integrators(maker, 0.25, 1e-3);
}

TEST(LayeredSurface, OfNothingIsInvisible) {
  auto maker = ball_under_sky();
  add_ball(maker, maker.material(Null{}));
  expect_in_all_integrators(maker, 1, 1e-6);
}

TEST(LayeredSurface, IsBlackBehindIfOneSided) {
  for (const bool front : {true, false}) {
    auto maker = ball_under_sky();
    const auto material = maker.material(test::lambert(0.5f));
    maker.description().materials[material].two_sided = false;
    const float turn = front ? 1.0f : -1.0f;
    maker.add(QuadDescription{{-turn, -1, 0}, {2 * turn, 0, 0}, {0, 2, 0}, material});
    expect_in_all_integrators(maker, front ? 0.5 : 0, 1e-4);
  }
}

// A solid without a visible boundary that halves what has passed its diameter.
TEST(LayeredSurface, OfAClearSolidAbsorbsInside) {
  auto maker = ball_under_sky();
  maker.description().camera.vertical_fov_degrees = 0.5f;
  Principled model;
  model.transmission_weight = 1;
  model.specular_ior = 1;
  model.specular_roughness = 0;
  model.transmission_color.value = Rgb::gray(0.5f);
  model.transmission_depth = 2;
  add_ball(maker, maker.material(model));
  const auto mean = test::mean_radiance(maker.build(), {}, 400);
  EXPECT_NEAR(mean.value, 0.5, 1e-3 + 5 * mean.standard_error);
}

TEST(LayeredSurface, RefusesBlendsOfWhatDoesNotStandBefore) {
  auto maker = ball_under_sky();
  add_ball(maker, maker.material(Blend{.first = 0, .second = 0}));
  const auto scene = Scene::build(maker.description(), 1);
  ASSERT_FALSE(scene);
  EXPECT_NE(scene.error().message.find("must stand before the blend"), std::string::npos)
      << scene.error().message;
}

TEST(LayeredSurface, ScalesATextureByNegativeNumbersOnlyWhereValuesMayBeNegative) {
  const auto build = [](const Principled& model) {
    auto maker = ball_under_sky();
    maker.description().textures.push_back({.image = nullptr, .procedural = ProceduralTexture{}});
    add_ball(maker, maker.material(model));
    return Scene::build(maker.description(), 1);
  };
  Principled rotated, negative;
  rotated.tangent.rotation = ScalarParameter(-0.5f, 0);
  negative.base_metalness = ScalarParameter(-0.5f, 0);
  EXPECT_TRUE(build(rotated));
  EXPECT_FALSE(build(negative));
}

}  // namespace
}  // namespace tessera::core::integrators
