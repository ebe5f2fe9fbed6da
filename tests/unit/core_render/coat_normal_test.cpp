// SPDX-License-Identifier: Apache-2.0
// Coats with normals of their own.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

#include "core/integrators/vertex.hpp"
#include "tests/support/mean_radiance.hpp"
#include "tests/support/near.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

constexpr float kCoatTilt = 0.3f;
const Vec3 kLeaningToU{kCoatTilt, 0, std::sqrt(1 - kCoatTilt * kCoatTilt)};

Texture strip_of(std::vector<float> texels, int width) {
  return {.image = std::make_shared<TextureImage>(TextureImage{width, 1, std::move(texels)})};
}
// Of one normal, towards u.
Texture tilted_normals() {
  return strip_of({kLeaningToU.x / 2 + 0.5f, 0.5f, kLeaningToU.z / 2 + 0.5f}, 1);
}

// A smooth coat over nothing.
Principled coat_alone() {
  Principled model;
  model.base_color.value = {};
  model.specular_weight = 0;
  model.coat_weight = 1;
  return model;
}

// The normal by which the coat reflects: midway between the viewer and what is seen.
Vec3 seen_coat_normal(const Principled& model, int normal_map, const Ray& ray) {
  test::SceneMaker maker({});
  maker.description().textures = {tilted_normals()};
  const auto coated = maker.material(model);
  maker.description().materials[coated].normal_map = {normal_map, 1};
  maker.add(QuadDescription{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, coated});
  const Scene scene = maker.build();
  const Hit hit = scene.bvh().closest_hit(scene.primitives(), ray);
  EXPECT_TRUE(hit.found());
  const PathVertex vertex(scene, ray, hit);
  const auto reflected = vertex.sample({}, 0);
  EXPECT_TRUE(reflected && reflected->delta);
  return normalize(reflected->wi + vertex.wo());
}

const Ray kRayOntoCoat{{0.3f, 0.3f, 5}, {0, 0, -1}}, kRayFromBehind{{0.3f, 0.3f, -5}, {0, 0, 1}};

TEST(CoatNormal, IsThatOfTheBaseByDefault) {
  expect_near(seen_coat_normal(coat_alone(), -1, kRayOntoCoat), {0, 0, 1}, 2e-3f);
  expect_near(seen_coat_normal(coat_alone(), 0, kRayOntoCoat), kLeaningToU, 2e-3f);
}

TEST(CoatNormal, IsThatOfItsOwnMap) {
  Principled model = coat_alone();
  model.geometry_coat_normal = {0, 1};
  expect_near(seen_coat_normal(model, -1, kRayOntoCoat), kLeaningToU, 2e-3f);
  expect_near(seen_coat_normal(model, -1, kRayFromBehind), -kLeaningToU, 2e-3f);
  model.geometry_coat_normal.strength = -1;
  expect_near(seen_coat_normal(model, 0, kRayOntoCoat), {-kLeaningToU.x, 0, kLeaningToU.z}, 2e-3f);
}

TEST(CoatNormal, IsFlatUnderAMapOfStrengthZero) {
  Principled model = coat_alone();
  model.geometry_coat_normal = {0, 0};
  expect_near(seen_coat_normal(model, 0, kRayOntoCoat), {0, 0, 1}, 2e-3f);
}

// A ball under an even sky of radiance 1 whose coat and base have normals that lean all ways.
Scene ball_with_two_reliefs(const Principled& model) {
  test::SceneMaker maker({.position = {0, 0, 4}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 26});
  maker.description().environment = EnvironmentDescription{{Rgb::gray(1)}};
  Texture coat = strip_of({0.35f, 0.5f, 1, 0.5f, 0.7f, 1, 0.6f, 0.4f, 1}, 3), base = coat;
  coat.scale = {7, 1};
  base.scale = {-4, 3};
  maker.description().textures = {coat, base};
  const auto material = maker.material(model);
  maker.description().materials[material].normal_map = {1, 1};
  maker.add(SphereDescription{{0, 0, 0}, 1, material});
  return maker.build();
}

Principled white_under_coat(float coat_roughness) {
  Principled model;
  model.base_color.value = Rgb::gray(1);
  model.coat_weight = 1;
  model.coat_roughness = coat_roughness;
  model.geometry_coat_normal = {0, 1};
  return model;
}

TEST(WhiteFurnace, CoatNormalsAreInvisible) {
  for (const float roughness : {0.0f, 0.3f, 0.7f}) {
    const Scene scene = ball_with_two_reliefs(white_under_coat(roughness));
    for (const test::Strategy& strategy : test::kStrategies) {
      const auto mean = test::mean_radiance(scene, {.integrator = strategy.integrator}, 400);
      EXPECT_NEAR(mean.value, 1, 0.01 + 5 * mean.standard_error) << strategy.name << ' ' << roughness;
    }
  }
}

// The coat reflects in one direction, and the pane below it reflects in another one and transmits.
TEST(WhiteFurnace, ACoatAndAPaneReflectInDirectionsOfTheirOwn) {
  Principled pane = white_under_coat(0);
  pane.specular_roughness = 0;
  pane.transmission_weight = 1;
  pane.geometry_thin_walled = true;
  const Scene scene = ball_with_two_reliefs(pane);
  for (const Integrator integrator : {Integrator::kMis, Integrator::kWhitted}) {
    const auto mean = test::mean_radiance(scene, {.integrator = integrator}, 400);
    EXPECT_NEAR(mean.value, 1, 0.01 + 5 * mean.standard_error);
  }
}

}  // namespace
}  // namespace tessera::core::integrators
