// SPDX-License-Identifier: Apache-2.0
// Which way normal maps bend normals, on surfaces whose texture coordinates are known.
#include <gtest/gtest.h>

#include <memory>

#include "core/integrators/vertex.hpp"
#include "tests/support/near.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

constexpr float kLean = 0.4f;

// An image of one normal.
Texture normal_texture(float x, float y) {
  const float z = std::sqrt(1 - x * x - y * y);
  const TextureImage image{1, 1, std::vector<float>{x / 2 + 0.5f, y / 2 + 0.5f, z / 2 + 0.5f}};
  return {.image = std::make_shared<TextureImage>(image)};
}

// The normal that a mirror of this shape is shaded with where `ray` meets it: midway between the viewer and
// what is seen.
Vec3 shaded_normal(const ShapeDescription& shape, const Texture& texture, const Ray& ray,
                   float strength = 1) {
  test::SceneMaker maker({});
  maker.description().textures = {texture};
  const auto mirror = maker.material(Mirror{});
  maker.description().materials[mirror].normal_map = {0, strength};
  maker.add(shape);
  const Scene scene = maker.build();
  const Hit hit = scene.bvh().closest_hit(scene.primitives(), ray);
  EXPECT_TRUE(hit.found());
  const PathVertex vertex(scene, ray, hit);
  return normalize(vertex.sample({}, 0)->wi + vertex.wo());
}

const Vec3 kTowardsX = {kLean, 0, std::sqrt(1 - kLean * kLean)};
const Vec3 kTowardsY = {0, kLean, std::sqrt(1 - kLean * kLean)};
const Ray kFromAbove{{0.3f, 0.3f, 5}, {0, 0, -1}}, kFromBelow{{0.3f, 0.3f, -5}, {0, 0, 1}};

// u along x, v along y, seen from +z.
QuadDescription quad() {
  return {{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 0};
}

// A triangle of the plane z = 0 with the given texture coordinates.
MeshDescription triangle(Vec2 uv0, Vec2 uv1, Vec2 uv2) {
  return {.positions = {{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}},
          .normals = {},
          .uvs = {uv0, uv1, uv2},
          .triangles = {{0, 1, 2}},
          .triangle_materials = {0}};
}

TEST(NormalMap, RedLeansTowardsUAndGreenTowardsV) {
  expect_near(shaded_normal(quad(), normal_texture(kLean, 0), kFromAbove), kTowardsX, 2e-3f);
  expect_near(shaded_normal(quad(), normal_texture(0, kLean), kFromAbove), kTowardsY, 2e-3f);
  expect_near(shaded_normal(quad(), normal_texture(0, 0), kFromAbove), {0, 0, 1}, 2e-3f);
}

// A bump is a dent from behind.
TEST(NormalMap, IsTheSameSurfaceFromBehind) {
  expect_near(shaded_normal(quad(), normal_texture(kLean, 0), kFromBelow), -kTowardsX, 2e-3f);
}

TEST(NormalMap, FollowsMirroredAndTurnedCoordinates) {
  const auto bent = [](const MeshDescription& mesh, float x, float y) {
    return shaded_normal(mesh, normal_texture(x, y), kFromAbove);
  };
  const MeshDescription mirrored = triangle({1, 0}, {0, 0}, {1, 1}),
                        turned = triangle({0, 0}, {0, 1}, {-1, 0});
  expect_near(bent(mirrored, kLean, 0), {-kTowardsX.x, 0, kTowardsX.z}, 2e-3f);
  expect_near(bent(mirrored, 0, kLean), kTowardsY, 2e-3f);
  expect_near(bent(turned, kLean, 0), {0, -kLean, kTowardsY.z}, 2e-3f);
  expect_near(bent(turned, 0, kLean), kTowardsX, 2e-3f);
}

// The tangent is y, so that the bitangent is -x or x.
TEST(NormalMap, FollowsTangentsOfVertices) {
  MeshDescription mesh = triangle({0, 0}, {1, 0}, {0, 1});
  for (const float handedness : {1.0f, -1.0f}) {
    mesh.tangents.assign(3, {{0, 2, 0}, handedness});
    expect_near(shaded_normal(mesh, normal_texture(kLean, 0), kFromAbove), kTowardsY, 2e-3f);
    expect_near(shaded_normal(mesh, normal_texture(0, kLean), kFromAbove),
                {-handedness * kTowardsX.x, 0, kTowardsX.z}, 2e-3f);
  }
}

TEST(NormalMap, FollowsImagesMirroredByTheirScale) {
  Texture texture = normal_texture(kLean, 0);
  texture.scale = {-3, 1};
  expect_near(shaded_normal(quad(), texture, kFromAbove), {-kTowardsX.x, 0, kTowardsX.z}, 2e-3f);
}

// A sheared texture does what other coordinates of the surface do.
TEST(NormalMap, FollowsImagesTurnedByTheirShear) {
  Texture texture = normal_texture(kLean, 0);
  texture.scale = {0, 0}, texture.shear = {-1, 1};  // the image's u is -v, and its v is u
  expect_near(shaded_normal(quad(), texture, kFromAbove), {0, -kLean, kTowardsY.z}, 2e-3f);
  texture.shear = {2, 2};  // the image's u is v, and its v is u
  expect_near(shaded_normal(quad(), texture, kFromAbove), kTowardsY, 2e-3f);
  const float c = std::sqrt(0.75f), s = 0.5f;
  texture.scale = {3 * c, 3 * c}, texture.shear = {-3 * s, 3 * s};
  expect_near(shaded_normal(quad(), texture, kFromAbove), {kLean * c, -kLean * s, kTowardsX.z}, 2e-3f);
}

TEST(NormalMap, LeavesSurfacesWithoutCoordinatesAsTheyAre) {
  for (const MeshDescription& mesh :
       {triangle({0, 0}, {0, 0}, {0, 0}), triangle({0, 0}, {0.5f, 0.5f}, {1, 1})})
    expect_near(shaded_normal(mesh, normal_texture(kLean, 0), kFromAbove), {0, 0, 1}, 2e-3f);
}

TEST(NormalMap, StrengthMultipliesTheSlope) {
  const Vec3 n = shaded_normal(quad(), normal_texture(kLean, 0), kFromAbove, 0.5f);
  EXPECT_NEAR(n.x / n.z, 0.5f * kTowardsX.x / kTowardsX.z, 2e-3f);
  expect_near(shaded_normal(quad(), normal_texture(kLean, 0), kFromAbove, 0), {0, 0, 1}, 2e-3f);
}

// On a sphere u runs east, counter-clockwise about +y, and v north.
TEST(NormalMap, LeansEastAndNorthOnSpheres) {
  const SphereDescription ball{{0, 0, 0}, 1, 0};
  const Ray from_x{{5, 0, 0}, {-1, 0, 0}};
  expect_near(shaded_normal(ball, normal_texture(kLean, 0), from_x), {kTowardsX.z, 0, -kLean}, 2e-3f);
  expect_near(shaded_normal(ball, normal_texture(0, kLean), from_x), {kTowardsX.z, kLean, 0}, 2e-3f);
  const Ray from_pole{{0, 5, 0}, {0, -1, 0}};
  expect_near(shaded_normal(ball, normal_texture(kLean, 0), from_pole), {0, 1, 0}, 2e-3f);
}

// Interpolated normals that lean are bent in their own frame.
TEST(NormalMap, BendsInterpolatedNormals) {
  MeshDescription mesh = triangle({0, 0}, {1, 0}, {0, 1});
  const Vec3 leaning = normalize({0, 0.3f, 1});
  mesh.normals = {leaning, leaning, leaning};
  const Vec3 n = shaded_normal(mesh, normal_texture(kLean, 0), kFromAbove);
  expect_near(n, Vec3{1, 0, 0} * kLean + leaning * kTowardsX.z, 2e-3f);
}

}  // namespace
}  // namespace tessera::core::integrators
