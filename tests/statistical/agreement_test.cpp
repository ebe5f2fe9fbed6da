// The strategies of path tracing differ in noise alone: region by region, they agree in expectation.
#include <gtest/gtest.h>

#include <memory>

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

// A sky whose power dwarfs the lamp's by ten orders of magnitude hides neither.
TEST(Strategies, AgreeUnderASky) {
  test::SceneMaker maker({.position = {0, 2, 6}, .look_at = {0, 0.5f, 0}});
  maker.add(QuadDescription{{-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, maker.material(test::lambert(0.6f))});
  maker.add(SphereDescription{{0, 1.5f, 0}, 0.5f, maker.material(test::lambert(0), {4, 3, 2})});
  maker.add(SphereDescription{{0, 0, 0}, 1e5f, maker.material(test::lambert(0), Rgb::gray(0.02f))});
  expect_strategies_agree(maker.description());
}

// Lamps with and without extent, a screen with a picture on it, and a picture of the surroundings.
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

}  // namespace
}  // namespace tessera::core
