// SPDX-License-Identifier: Apache-2.0
// The strategies of path tracing differ in noise alone: region by region, they agree in expectation.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "tests/statistical/agreement.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core {
namespace {

using test::expect_strategies_agree;

TEST(Strategies, AgreeInARoomOfEveryMaterial) {
  expect_strategies_agree(test::room());
}

// Microfacets, highlights, a frosted ball with a lamp's light behind it, and bent normals.
TEST(Strategies, AgreeInARoomOfGlossyMaterials) {
  SceneDescription room = test::room();
  const TextureImage dents{2, 2,
                           std::vector<float>{.5f, .5f, 1, .7f, .4f, .9f, .4f, .7f, .9f, .3f, .3f, .8f}};
  room.textures = {{.image = std::make_shared<TextureImage>(dents), .scale = {5, 5}}};
  room.materials[0].model = Phong{.diffuse = {Rgb::gray(0.5f)}, .specular = {Rgb::gray(0.3f)}};
  room.materials[0].normal_map = {0, 0.7f};
  room.materials[1].model =
      CookTorrance{.diffuse = {{0.5f, 0.1f, 0.1f}}, .specular = {Rgb::gray(0.5f)}, .roughness = 0.5f};
  room.materials[4].model = CookTorrance{.conductor = Conductor::kCopper, .roughness = 0.5f};
  room.materials[4].normal_map = {0, 1};
  room.materials[5].model = Glass{.roughness = 0.6f};
  expect_strategies_agree(room);
}

// Translucent walls, mirrors and glass; lamps that let light pass, of each shape, one through a mask; and
// light from outside.
TEST(Strategies, AgreeInATranslucentRoom) {
  SceneDescription room = test::room();
  const TextureImage mask{2, 2, std::vector<float>{0, 0, 0, 1, 1, 1, 0.5f, 0.5f, 0.5f, 1, 1, 1}};
  room.textures = {{.image = std::make_shared<TextureImage>(mask), .scale = {3, 3}}};
  for (Material& material : room.materials) material.opacity = 0.7f;
  room.materials[0].opacity = {0.9f, 0};
  room.materials[2].opacity = {1, 0};
  room.shapes.push_back(
      MeshDescription{.positions = {{-0.8f, 0.2f, 0.7f}, {-0.2f, 0.2f, 0.8f}, {-0.5f, 0.9f, 0.6f}},
                      .normals = {},
                      .uvs = {{0, 0}, {1, 0}, {0, 1}},
                      .triangles = {{0, 1, 2}},
                      .triangle_materials = {3}});
  room.environment = {{{0.4f, 0.5f, 0.8f}}};
  room.lights = {PointLightDescription{{0, 1.5f, 2}, {2, 2, 1}}};
  expect_strategies_agree(room);
}

// A sky whose power dwarfs the lamp's by ten orders of magnitude hides neither.
TEST(Strategies, AgreeUnderASky) {
  test::SceneMaker maker({.position = {0, 2, 6}, .look_at = {0, 0.5f, 0}});
  maker.add(QuadDescription{{-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, maker.material(test::lambert(0.6f))});
  maker.add(SphereDescription{{0, 1.5f, 0}, 0.5f, maker.material(test::lambert(0), {4, 3, 2})});
  maker.add(SphereDescription{{0, 0, 0}, 1e5f, maker.material(test::lambert(0), Rgb::gray(0.02f))});
  expect_strategies_agree(maker.description());
}

// Lamps with and without extent, a screen with an image on it, and an image of the environment.
TEST(Strategies, AgreeUnderLightsOfEveryKind) {
  test::SceneMaker maker({.position = {0, 1.5f, 6}, .look_at = {0, 0.8f, 0}});
  const TextureImage checks{2, 2, std::vector<float>{4, 1, 1, 0, 0, 0, 1, 2, 1, 6, 6, 1}};
  const TextureImage sky{4, 3,
                         std::vector<float>{1,   1,   2,   1,   1,   2,   9,   8,   6,   1,   1,   2,  //
                                            0,   0,   0,   1,   1,   1,   0,   0,   0,   0,   1,   0,  //
                                            .2f, .2f, .2f, .2f, .2f, .2f, .2f, .2f, .2f, .2f, .2f, .2f}};
  maker.description().textures = {{.image = std::make_shared<TextureImage>(checks)},
                                  {.image = std::make_shared<TextureImage>(sky)}};
  const auto white = maker.material(test::lambert(0.7f));
  const auto screen = maker.material(test::lambert(0.2f));
  maker.description().materials[screen].emission = {Rgb::gray(2), 0};
  maker.add(QuadDescription{{-4, 0, 4}, {8, 0, 0}, {0, 0, -8}, white});
  maker.add(QuadDescription{{-2, 0, -2}, {2, 0, 0}, {0, 1.5f, 0.3f}, screen});
  maker.add(SphereDescription{{-1, 0.6f, 0}, 0.6f, white});
  maker.add(SphereDescription{{1.5f, 0.5f, 0}, 0.5f, maker.material(Mirror{})});
  maker.add(SphereDescription{{0.4f, 0.4f, 1}, 0.4f, maker.material(Glass{})});
  maker.add(SphereDescription{{0.3f, 0.9f, -1}, 0.3f, screen});
  maker.description().lights = {
      PointLightDescription{{-2, 2, 1}, {2, 2, 1}},
      SpotLightDescription{
          .position = {2, 3, 1}, .look_at = {1, 0, 0}, .intensity = {6, 4, 4}, .softness = 0.5f},
      DirectionalLightDescription{{1, -1, -0.5f}, {0.3f, 0.4f, 0.5f}}};
  maker.description().environment = {{Rgb::gray(0.5f), 1}, 40};
  expect_strategies_agree(maker.description());
}

// A sky of which BSDF samples find most: with a small sun, without, and both beside a lamp.
TEST(Strategies, AgreeUnderASkyWithASmallSun) {
  for (const bool with_sun : {true, false}) {
    test::SceneMaker maker({.position = {0, 2, 6}, .look_at = {0, 0.5f, 0}});
    std::vector<float> texels(std::size_t{3} * 32 * 16, 0.5f);
    if (with_sun) std::fill_n(texels.begin() + 3 * (32 * 4 + 19), 3, 60.0f);
    maker.description().textures = {
        {.image = std::make_shared<TextureImage>(TextureImage{32, 16, std::move(texels)})}};
    maker.description().environment = {{Rgb::gray(0.8f), 0}};
    maker.add(QuadDescription{{-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, maker.material(test::lambert(0.6f))});
    maker.add(SphereDescription{{-1.2f, 0.7f, 0}, 0.7f, maker.material(Glass{.roughness = 0.5f})});
    maker.add(
        SphereDescription{{1.2f, 0.7f, 0},
                          0.7f,
                          maker.material(CookTorrance{.specular = {Rgb::gray(0.5f)}, .roughness = 0.4f})});
    maker.add(SphereDescription{{0, 2.2f, 0}, 0.3f, maker.material(test::lambert(0), {4, 3, 2})});
    expect_strategies_agree(maker.description());
  }
}

// A hundred lamps of a few facets each, some turned away, over a floor with a frosted ball.
TEST(Strategies, AgreeAmongManyLamps) {
  test::SceneMaker maker({.position = {0, 3, 7}, .look_at = {0, 0.5f, 0}});
  const auto floor = maker.material(test::lambert(0.6f));
  const auto frosted = maker.material(Glass{.roughness = 0.6f});
  const auto warm = maker.material(test::lambert(0.3f), {9, 6, 3}, false);
  const auto cold = maker.material(test::lambert(0.3f), {0.2f, 0.3f, 1});
  maker.add(QuadDescription{{-5, 0, 5}, {10, 0, 0}, {0, 0, -10}, floor});
  maker.add(SphereDescription{{0, 1, 0}, 1, frosted});
  for (int i = 0; i < 100; ++i) {
    const Vec3 p{static_cast<float>(i % 10) - 4.5f, 0.2f + static_cast<float>(i % 7) * 0.3f,
                 static_cast<float>(i / 10) - 4.5f};
    const float side = 0.1f + static_cast<float>(i % 3) * 0.05f;
    maker.add(
        MeshDescription{.positions = {p, p + Vec3{side, 0, 0}, p + Vec3{0, side, 0}, p + Vec3{0, 0, side}},
                        .normals = {},
                        .uvs = {},
                        .triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}},
                        .triangle_materials = {i % 4 == 0 ? cold : warm}});
  }
  maker.description().lights = {PointLightDescription{{-2, 2, 1}, {2, 2, 1}},
                                DirectionalLightDescription{{1, -1, -0.5f}, {0.3f, 0.4f, 0.5f}}};
  expect_strategies_agree(maker.description());
}

// A pyramid whose sides emit outwards alone, with leaning normals.
MeshDescription pyramid(std::uint32_t material) {
  return {.positions = {{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, {0, 2, 0}},
          .normals = {{-1, 1, 1}, {1, 1, 1}, {1, 1, -1}, {-1, 1, -1}, {0, 1, 0}},
          .uvs = {},
          .triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}},
          .triangle_materials = {material}};
}

MeshDescription moved(MeshDescription mesh, const Transform& transform) {
  for (Vec3& p : mesh.positions) p = transform.point(p);
  const bool mirrored = transform.determinant() < 0;
  for (Vec3& n : mesh.normals) n = transform.normal(n) * (mirrored ? -1.0f : 1.0f);
  if (mirrored)
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

// Lamps of each shape in instances that are turned, mirrored and stretched, with and without a material of
// their own, among instances of glass.
struct Lanterns {
  Lanterns() {
    TextureImage checks{2, 2, std::vector<float>{8, 2, 2, 0, 0, 0, 2, 4, 2, 12, 12, 2}};
    maker.description().textures = {{.image = std::make_shared<TextureImage>(std::move(checks))}};
    maker.add(QuadDescription{{-4, 0, 4}, {8, 0, 0}, {0, 0, -8}, white});
    maker.description().materials[screen].emission = {Rgb::gray(2), 0};
  }

  const Transform left = compose(translation({-1.4f, 0.4f, 0.3f}),
                                 compose(rotation({1, 3, -1}, 140), scaling({0.3f, 0.3f, 0.3f})));
  const Transform right = compose(translation({1.2f, 0.1f, 0.6f}),
                                  compose(rotation({1, 1, 0}, 25), scaling({-0.3f, 0.5f, 0.2f})));
  const Transform egg =
      compose(translation({0, 0.8f, 0}), compose(rotation({0, 0, 1}, 20), scaling({-0.6f, 0.4f, 0.5f})));

  test::SceneMaker maker{{.position = {0, 1.5f, 6}, .look_at = {0, 0.8f, 0}}};
  const std::uint32_t white = maker.material(test::lambert(0.7f));
  const std::uint32_t lamp = maker.material(test::lambert(0.3f), {5, 4, 3}, false);
  const std::uint32_t screen = maker.material(test::lambert(0.2f));
  const std::uint32_t glass = maker.material(Glass{});
};

TEST(Strategies, AgreeUnderInstancesOfLamps) {
  Lanterns lanterns;
  auto& maker = lanterns.maker;
  maker.description().objects = {
      {"lantern",
       {pyramid(lanterns.lamp), SphereDescription{{0, 3, 0}, 0.8f, lanterns.screen},
        QuadDescription{{-2, 0, 0}, {0, 2, 0}, {0, 0, 2}, lanterns.lamp}},
       {}},
      {"ball", {SphereDescription{{0, 0, 0}, 1, lanterns.glass}}, {}}};
  maker.add(InstanceDescription{0, lanterns.left, std::nullopt});
  maker.add(InstanceDescription{0, translation({2, 0, -2}), lanterns.white});
  maker.add(InstanceDescription{0, compose(translation({0, 2.5f, -2}), scaling({0.3f, -0.3f, 0.3f})),
                                lanterns.screen});
  maker.add(InstanceDescription{1, lanterns.egg, std::nullopt});
  expect_strategies_agree(maker.description());
}

TEST(Strategies, AgreeOnInstancesAndOnMovedMeshes) {
  Lanterns instances, meshes;
  instances.maker.description().objects = {{"lantern", {pyramid(instances.lamp)}, {}},
                                           {"glass", {pyramid(instances.glass)}, {}}};
  const std::pair<const Transform*, std::uint32_t> shown[] = {
      {&instances.left, 0}, {&instances.right, 0}, {&instances.egg, 1}};
  for (const auto& [transform, object] : shown) {
    instances.maker.add(InstanceDescription{object, *transform, std::nullopt});
    meshes.maker.add(moved(pyramid(object == 0 ? meshes.lamp : meshes.glass), *transform));
  }
  test::expect_scenes_agree(instances.maker.description(), meshes.maker.description());
}

}  // namespace
}  // namespace tessera::core
