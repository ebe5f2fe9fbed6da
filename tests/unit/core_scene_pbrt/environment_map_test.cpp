// SPDX-License-Identifier: Apache-2.0
// The images of infinite lights: the equal-area octahedral mapping, and its resampling.
#include "core/scene/pbrt/environment_map.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/lights/equirectangular.hpp"
#include "tests/unit/core_scene_pbrt/pbrt_scene.hpp"

namespace tessera::core::test {
namespace {

using pbrt::equal_area_direction;
using pbrt::equal_area_square;

TEST(PbrtEnvironment, TheMappingIsItsOwnInverse) {
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) {
      const Vec2 p{(static_cast<float>(i) + 0.3f) / 12, (static_cast<float>(j) + 0.6f) / 12};
      const Vec3 d = equal_area_direction(p);
      EXPECT_NEAR(length(d), 1, 1e-5);
      const Vec2 back = equal_area_square(d);
      EXPECT_NEAR(back.x, p.x, 1e-4);
      EXPECT_NEAR(back.y, p.y, 1e-4);
    }
  EXPECT_NEAR(equal_area_direction({0.5f, 0.5f}).z, 1, 1e-6);
  EXPECT_NEAR(equal_area_direction({0.001f, 0.001f}).z, -1, 1e-2);
  EXPECT_NEAR(equal_area_direction({0.999f, 0.5f}).x, 1, 1e-2);
  EXPECT_NEAR(equal_area_direction({0.5f, 0.999f}).y, 1, 1e-2);
}

TEST(PbrtEnvironment, TheMappingKeepsAreas) {
  // A fraction (1 - z) / 2 of the sphere is above z.
  constexpr int kSide = 200;
  for (const float z : {-0.8f, -0.2f, 0.3f, 0.9f}) {
    int above = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
      const Vec2 p{(static_cast<float>(i % kSide) + 0.5f) / kSide,
                   (static_cast<float>(i / kSide) + 0.5f) / kSide};
      above += equal_area_direction(p).z > z ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<float>(above) / (kSide * kSide), (1 - z) / 2, 0.005) << z;
  }
}

// An image whose texels have the colour of their direction.
std::string directions_image(int side) {
  Image image(side, side);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const Vec3 d = equal_area_direction({(static_cast<float>(x) + 0.5f) / static_cast<float>(side),
                                           (static_cast<float>(y) + 0.5f) / static_cast<float>(side)});
      image.at(x, y) = {d.x + 1, d.y + 1, d.z + 1};
    }
  return hdr(image);
}

// Not at the poles, where the texture would repeat.
Rgb environment_at(const SceneDescription& scene, Vec3 direction) {
  const ColorParameter& radiance = scene.environment->radiance;
  const Vec2 uv = lights::EquirectangularMap(0).uv_of(direction);
  return radiance.evaluate(scene.textures, uv);
}

TEST(PbrtEnvironment, ImagesTurnWithTheirLight) {
  const MemoryAssets::Files files{{"sky.hdr", directions_image(32)}};
  const std::string light = "LightSource \"infinite\" \"string filename\" \"sky.hdr\" Shape \"sphere\"";
  const SceneDescription plain = pbrt_world(light, files);
  ASSERT_TRUE(plain.environment && plain.environment->radiance.texture >= 0);
  const SceneDescription turned = pbrt_world("Rotate 90 1 0 0 " + light, files);
  for (const Vec3 d :
       {Vec3{1, 0, 0}, Vec3{0.05f, 0.998f, 0.03f}, Vec3{0, 0, -1}, Vec3{0.6f, 0.48f, -0.64f}}) {
    const Rgb own = environment_at(plain, d);
    EXPECT_NEAR(own.r, d.x + 1, 0.08);
    EXPECT_NEAR(own.g, d.y + 1, 0.08);
    EXPECT_NEAR(own.b, d.z + 1, 0.08);
    // The light's z axis points along -y, and its y axis along z.
    const Rgb other = environment_at(turned, d);
    EXPECT_NEAR(other.r, d.x + 1, 0.08);
    EXPECT_NEAR(other.g, d.z + 1, 0.08);
    EXPECT_NEAR(other.b, -d.y + 1, 0.08);
  }
}

TEST(PbrtEnvironment, ResamplingKeepsTheLight) {
  Image image(16, 16);
  for (auto& pixel : image.pixels) pixel = Rgb::gray(1);
  image.at(3, 5) = Rgb::gray(257);
  const SceneDescription scene = pbrt_world(
      "LightSource \"infinite\" \"string filename\" \"sky.hdr\" \"float scale\" 2 Shape \"sphere\"",
      {{"sky.hdr", hdr(image)}});
  const TextureImage& made = *scene.textures.at(0).image;
  double sum = 0, weights = 0;
  for (int y = 0; y < made.height(); ++y) {
    const double weight = std::sin(std::numbers::pi * (y + 0.5) / made.height());
    for (int x = 0; x < made.width(); ++x) {
      sum += weight * static_cast<double>(made.texel(x, y).g);
      weights += weight;
    }
  }
  EXPECT_NEAR(sum / weights, 4, 0.04);
}

TEST(PbrtEnvironment, IlluminanceOfTheUpperHalf) {
  Image image(64, 64);
  for (auto& pixel : image.pixels) pixel = Rgb::gray(5);
  const SceneDescription scene = pbrt_world(
      "LightSource \"infinite\" \"string filename\" \"sky.hdr\" \"float illuminance\" 10 Shape \"sphere\"",
      {{"sky.hdr", hdr(image)}});
  // As pbrt-v4 computes it: 2 pi times the mean of the cosine over the sphere, which is 1 / 4.
  EXPECT_NEAR(environment_at(scene, {0, 0, 1}).g, 10 / (std::numbers::pi / 2), 0.1);
}

}  // namespace
}  // namespace tessera::core::test
