// SPDX-License-Identifier: Apache-2.0
// The direction along which anisotropic highlights are stretched, on surfaces whose texture coordinates are
// known.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/integrators/vertex.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

constexpr float kFromU = 1.0f / 12;  // 30 degrees, in turns

// A picture of one direction, by its angle in turns.
Texture direction_texture(float turns) {
  const Vec2 d = turned({1, 0}, turns);
  const TextureImage image{1, 1, std::vector<float>{d.x / 2 + 0.5f, d.y / 2 + 0.5f, 1}};
  return {.image = std::make_shared<TextureImage>(image)};
}

const Ray kRayFromZ{{0.3f, 0.3f, 5}, {0, 0, -1}}, kRayToZ{{0.3f, 0.3f, -5}, {0, 0, 1}};

// u along x, v along y, seen from +z.
QuadDescription unit_square() {
  return {{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 0};
}

// The angle from x towards y in degrees, below 180, along which the highlight is longest where `ray` meets
// the shape in the plane z = 0.
int longest_at(const MaterialModel& model, const Ray& ray = kRayFromZ,
               const Texture& texture = direction_texture(0), const ShapeDescription& shape = unit_square()) {
  test::SceneMaker maker({});
  maker.description().textures = {texture};
  maker.material(model);
  maker.add(shape);
  const Scene scene = maker.build();
  const Hit hit = scene.bvh().closest_hit(scene.primitives(), ray);
  EXPECT_TRUE(hit.found());
  const PathVertex vertex(scene, ray, hit);
  const auto value_at = [&](int degrees) {
    const Vec2 d = turned({0.6f, 0}, static_cast<float>(degrees) / 360);
    return vertex.evaluate({d.x, d.y, std::copysign(0.8f, ray.origin.z)}).value.g;
  };
  int best = 0;
  for (int degrees = 1; degrees < 180; ++degrees)
    if (value_at(degrees) > value_at(best)) best = degrees;
  return best;
}

std::vector<std::pair<std::string, MaterialModel>> models_along(const TangentDirection& tangent) {
  return {{"conductor", ConductorMaterial{.roughness = 0.5f, .anisotropy = 0.8f, .tangent = tangent}},
          {"beckmann", ConductorMaterial{.roughness = 0.5f,
                                         .anisotropy = 0.8f,
                                         .tangent = tangent,
                                         .microfacets = {MicrofacetDistribution::kBeckmann}}},
          {"disney", Disney{.metallic = 1, .anisotropic = 0.8f, .tangent = tangent}},
          {"principled", Principled{.base_metalness = 1,
                                    .specular_roughness = 0.5f,
                                    .specular_roughness_anisotropy = 0.8f,
                                    .tangent = tangent}}};
}

TEST(Tangent, IsThatOfGrowingUTurnedTowardsV) {
  for (const auto& [name, model] : models_along({})) EXPECT_EQ(longest_at(model), 0) << name;
  for (const auto& [name, model] : models_along({{}, kFromU})) {
    EXPECT_NEAR(longest_at(model), 30, 1) << name;
    EXPECT_NEAR(longest_at(model, kRayToZ), 30, 1) << name;
  }
}

TEST(Tangent, IsThatOfATexture) {
  for (const auto& [name, model] : models_along({{0}}))
    EXPECT_NEAR(longest_at(model, kRayFromZ, direction_texture(kFromU)), 30, 1) << name;
  for (const auto& [name, model] : models_along({{0}, 0.25f}))
    EXPECT_NEAR(longest_at(model, kRayFromZ, direction_texture(kFromU)), 120, 1) << name;
}

TEST(Tangent, MayBeTurnedByATexture) {
  const TextureImage image{1, 1, std::vector<float>{kFromU, 0, 0}};
  const Texture angle{.image = std::make_shared<TextureImage>(image)};
  for (const auto& [name, model] : models_along({{}, {2, 0}}))
    EXPECT_NEAR(longest_at(model, kRayFromZ, angle), 60, 1) << name;
}

TEST(Tangent, FollowsMirroredImagesAndCoordinates) {
  const MaterialModel model = models_along({{0}}).front().second;
  Texture mirrored = direction_texture(kFromU);
  mirrored.scale = {-3, 1};
  EXPECT_NEAR(longest_at(model, kRayFromZ, mirrored), 150, 1);
  const MeshDescription mesh{.positions = {{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}},
                             .normals = {},
                             .uvs = {{1, 0}, {0, 0}, {1, 1}},
                             .triangles = {{0, 1, 2}},
                             .triangle_materials = {0}};
  EXPECT_NEAR(longest_at(model, kRayFromZ, direction_texture(kFromU), mesh), 150, 1);
  const MaterialModel by_angle = models_along({{}, kFromU}).front().second;
  EXPECT_NEAR(longest_at(by_angle, kRayFromZ, direction_texture(0), mesh), 150, 1);
}

// Texture coordinates along x and y, and a tangent of 30 degrees.
MeshDescription with_tangents(float handedness) {
  const Vec2 d = turned({1, 0}, kFromU);
  return {.positions = {{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}},
          .normals = {},
          .uvs = {{0, 0}, {1, 0}, {0, 1}},
          .triangles = {{0, 1, 2}},
          .triangle_materials = {0},
          .tangents = std::vector<VertexTangent>(3, {{d.x, d.y, 0}, handedness})};
}

TEST(Tangent, IsThatOfVerticesWhereAMeshHasThem) {
  for (const auto& [name, model] : models_along({}))
    EXPECT_NEAR(longest_at(model, kRayFromZ, direction_texture(0), with_tangents(1)), 30, 1) << name;
  for (const auto& [name, model] : models_along({{}, kFromU})) {
    EXPECT_NEAR(longest_at(model, kRayFromZ, direction_texture(0), with_tangents(1)), 60, 1) << name;
    EXPECT_EQ(longest_at(model, kRayFromZ, direction_texture(0), with_tangents(-1)) % 180, 0) << name;
  }
  // The transform of an image moves what it shows, not the frame.
  Texture mirrored = direction_texture(kFromU);
  mirrored.scale = {-3, 1};
  for (const auto& [name, model] : models_along({{0}}))
    EXPECT_NEAR(longest_at(model, kRayFromZ, mirrored, with_tangents(1)), 60, 1) << name;
}

TEST(Tangent, OfSurfacesWithoutCoordinatesIsNotTurned) {
  const MeshDescription mesh{.positions = {{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}},
                             .normals = {},
                             .uvs = {},
                             .triangles = {{0, 1, 2}},
                             .triangle_materials = {0}};
  const Texture any = direction_texture(kFromU);
  for (std::size_t i = 0; i < models_along({}).size(); ++i)
    EXPECT_EQ(longest_at(models_along({{0}, kFromU})[i].second, kRayFromZ, any, mesh),
              longest_at(models_along({})[i].second, kRayFromZ, any, mesh));
}

// Of a coat over nothing.
Principled coat_along(const TangentDirection& coat, const TangentDirection& base) {
  return {.base_color = {Rgb{}},
          .specular_weight = 0,
          .specular_roughness_anisotropy = 0.8f,
          .coat_weight = 1,
          .coat_roughness = 0.5f,
          .coat_roughness_anisotropy = 0.8f,
          .tangent = base,
          .coat_tangent = coat};
}

TEST(Tangent, OfTheCoatIsItsOwn) {
  EXPECT_EQ(longest_at(coat_along({}, {{}, kFromU})), 0);
  for (const TangentDirection& base : {TangentDirection{}, TangentDirection{{}, 0.2f}}) {
    EXPECT_NEAR(longest_at(coat_along({{}, kFromU}, base)), 30, 1);
    EXPECT_NEAR(longest_at(coat_along({{0}}, base), kRayFromZ, direction_texture(2 * kFromU)), 60, 1);
  }
}

}  // namespace
}  // namespace tessera::core::integrators
