// SPDX-License-Identifier: Apache-2.0
// Which way heights tilt normals, on surfaces whose texture coordinates are known.
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <vector>

#include "core/integrators/vertex.hpp"
#include "core/math/elementary.hpp"
#include "tests/support/near.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators::bump_map_test {
namespace {

// A ramp that rises from 0 to 1 along u, or along v.
Texture ramp(bool along_u) {
  constexpr int kTexels = 64;
  std::vector<float> values;
  for (int i = 0; i < kTexels; ++i) {
    const float height = (static_cast<float>(along_u ? i : kTexels - 1 - i) + 0.5f) / kTexels;
    values.insert(values.end(), {height, 0.3f, 0.9f});
  }
  const auto image = along_u ? TextureImage(kTexels, 1, values) : TextureImage(1, kTexels, values);
  return {.image = std::make_shared<TextureImage>(image), .wrap = Wrap::kClamp};
}

// The normal that a mirror of this shape is shaded with where `ray` meets it.
Vec3 shaded_normal(const ShapeDescription& shape, const Texture& heights, float height, const Ray& ray,
                   std::optional<Transform> instance = {}) {
  test::SceneMaker maker({});
  maker.description().textures = {heights};
  const auto mirror = maker.material(Mirror{});
  maker.description().materials[mirror].bump = {0, height};
  if (instance) {
    maker.description().objects = {{"object", {shape}, {}}};
    maker.add(InstanceDescription{0, *instance, std::nullopt});
  } else {
    maker.add(shape);
  }
  const Scene scene = maker.build();
  const Hit hit = scene.bvh().closest_hit(scene.primitives(), ray);
  EXPECT_TRUE(hit.found());
  const PathVertex vertex(scene, ray, hit);
  return normalize(vertex.sample({}, 0)->wi + vertex.wo());
}

const Ray kFromAbove{{0.3f, 0.3f, 5}, {0, 0, -1}}, kFromBelow{{0.3f, 0.3f, -5}, {0, 0, 1}};
const QuadDescription kQuad{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 0};  // u along x, v along y

// Where the height rises by `slope` per unit of length, the normal leans back.
Vec3 leaning(float slope_x, float slope_y) {
  return normalize({-slope_x, -slope_y, 1});
}

TEST(BumpMap, LeansAwayFromWhereItRises) {
  expect_near(shaded_normal(kQuad, ramp(true), 0.6f, kFromAbove), leaning(0.3f, 0), 2e-3f);
  expect_near(shaded_normal(kQuad, ramp(false), 0.6f, kFromAbove), leaning(0, 0.3f), 2e-3f);
  expect_near(shaded_normal(kQuad, ramp(true), -0.6f, kFromAbove), leaning(-0.3f, 0), 2e-3f);
  expect_near(shaded_normal(kQuad, ramp(true), 0, kFromAbove), {0, 0, 1}, 2e-3f);
  expect_near(shaded_normal(kQuad, ramp(true), 0.6f, kFromBelow), -leaning(0.3f, 0), 2e-3f);
}

TEST(BumpMap, FollowsTextureCoordinates) {
  const auto triangle = [](Vec2 uv0, Vec2 uv1, Vec2 uv2) {
    return MeshDescription{.positions = {{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}},
                           .normals = {},
                           .uvs = {uv0, uv1, uv2},
                           .triangles = {{0, 1, 2}},
                           .triangle_materials = {0}};
  };
  const auto mirrored = triangle({1, 0}, {0, 0}, {1, 1}), turned = triangle({0, 0}, {0, 1}, {1, 0}),
             none = triangle({0.5f, 0.5f}, {0.5f, 0.5f}, {0.5f, 0.5f});
  expect_near(shaded_normal(mirrored, ramp(true), 1, kFromAbove), leaning(-0.25f, 0), 2e-3f);
  expect_near(shaded_normal(mirrored, ramp(false), 1, kFromAbove), leaning(0, 0.25f), 2e-3f);
  expect_near(shaded_normal(turned, ramp(true), 1, kFromAbove), leaning(0, 0.25f), 2e-3f);
  expect_near(shaded_normal(none, ramp(true), 1, kFromAbove), {0, 0, 1}, 2e-3f);
}

TEST(BumpMap, FollowsTheScaleOfTextures) {
  Texture texture = ramp(true);
  texture.scale = {-0.5f, 1};
  texture.offset = {1, 0};
  expect_near(shaded_normal(kQuad, texture, 1, kFromAbove), leaning(-0.25f, 0), 2e-3f);
  texture.scale = {0, 0};
  expect_near(shaded_normal(kQuad, texture, 1, kFromAbove), {0, 0, 1}, 2e-3f);
}

// The slope of the image's u, which is the surface's v times -0.5, and of its v.
TEST(BumpMap, FollowsTheShearOfTextures) {
  Texture texture = ramp(true);
  texture.scale = {0, 0}, texture.shear = {-0.5f, 0.5f};
  texture.offset = {1, 0};
  expect_near(shaded_normal(kQuad, texture, 1, kFromAbove), leaning(0, -0.25f), 2e-3f);
}

// u runs east, once around; v runs north, half around.
TEST(BumpMap, HasTheSlopeOfSpheres) {
  const SphereDescription ball{{0, 0, 0}, 2, 0};
  const Ray from_west{{-5, 0, 0}, {1, 0, 0}};  // u = 0.5, east is +z
  const float around = 2 * kPi * 2;
  expect_near(shaded_normal(ball, ramp(true), 3, from_west), normalize({-1, 0, -3 / around}), 2e-3f);
  expect_near(shaded_normal(ball, ramp(false), 3, from_west), normalize({-1, -6 / around, 0}), 2e-3f);
}

// Heights are in units of the world, however large an instance is.
TEST(BumpMap, KeepsHeightsInInstances) {
  const Transform doubled{{2, 0, 0}, {0, 2, 0}, {0, 0, 2}, {0, 0, 0}};
  expect_near(shaded_normal(kQuad, ramp(true), 0.6f, kFromAbove, doubled), leaning(0.15f, 0), 2e-3f);
  const SphereDescription ball{{0, 0, 0}, 1, 0};
  const Ray from_west{{-5, 0, 0}, {1, 0, 0}};
  expect_near(shaded_normal(ball, ramp(true), 3, from_west, doubled), normalize({-1, 0, -3 / (4 * kPi)}),
              2e-3f);
}

}  // namespace
}  // namespace tessera::core::integrators::bump_map_test
