// SPDX-License-Identifier: Apache-2.0
#include "core/scene/scene.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <memory>

#include "core/lights/light_sampler.hpp"
#include "core/scene/validation.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

std::string error_of(const SceneDescription& description) {
  const auto scene = Scene::build(description, 1);
  return scene ? "" : scene.error().message;
}

MeshDescription triangle() {
  return {.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
          .normals = {},
          .uvs = {},
          .triangles = {{0, 1, 2}},
          .triangle_materials = {0}};
}

SceneDescription with(ShapeDescription shape) {
  SceneDescription description = test::room();
  description.shapes = {std::move(shape)};
  return description;
}

TEST(Scene, FindsEveryLightAndItsPrimitives) {
  const Scene scene = Scene::build(test::room(), 1).value();
  ASSERT_EQ(scene.lights().size(), 2u);
  EXPECT_EQ(scene.primitives().triangle_count(), 12u);
  EXPECT_EQ(scene.light_of({.primitive = 10}), 0u);
  EXPECT_EQ(scene.light_of({.primitive = 11}), 0u) << "both triangles of a quad are one light";
  EXPECT_EQ(scene.light_of({.primitive = 14}), 1u) << "spheres come last";
  EXPECT_EQ(scene.light_of({.primitive = 0}), lights::kNoLight);
}

TEST(Scene, TrianglesWithoutAreaAreNoLights) {
  MeshDescription flat = triangle();
  flat.positions[2] = {2, 0, 0};
  flat.triangle_materials = {2};
  EXPECT_TRUE(Scene::build(with(flat), 1)->lights().empty());
}

TEST(Scene, IsDarkWhereNoShapeEmits) {
  EXPECT_TRUE(gives_light(test::room()));
  EXPECT_FALSE(gives_light(with(triangle()))) << "materials that no shape has do not count";
  MeshDescription lit = triangle();
  lit.triangle_materials = {2};
  EXPECT_TRUE(gives_light(with(lit)));
}

TEST(Scene, IsLitByWhatIsNoShape) {
  SceneDescription dark = with(triangle());
  dark.lights = {PointLightDescription{}};
  dark.environment = {{Rgb::gray(0)}};
  EXPECT_FALSE(gives_light(dark)) << "black lights do not count";
  EXPECT_TRUE(Scene::build(dark, 1)->lights().empty());
  for (const LightDescription& light :
       {LightDescription{PointLightDescription{{0, 0, 1}, {0, 0, 1}}},
        LightDescription{SpotLightDescription{.position = {0, 0, 1}, .look_at = {}, .intensity = {0, 1, 0}}},
        LightDescription{DirectionalLightDescription{{0, 0, -1}, {1, 0, 0}}}}) {
    SceneDescription lit = dark;
    lit.lights = {light};
    EXPECT_TRUE(gives_light(lit));
    EXPECT_EQ(Scene::build(lit, 1)->lights().size(), 1u);
  }
  dark.environment = {{Rgb::gray(1)}};
  EXPECT_TRUE(gives_light(dark));
  EXPECT_EQ(Scene::build(dark, 1)->environment_light(), 0u);
}

TEST(Scene, PutsLightsInOrderAndKnowsWhichNoRayMeets) {
  SceneDescription description = test::room();
  description.lights = {PointLightDescription{{0, 1, 0}, Rgb::gray(1)},
                        DirectionalLightDescription{{0, -1, 0}, Rgb::gray(1)}};
  description.environment = {{Rgb::gray(1)}};
  const Scene scene = Scene::build(description, 1).value();
  ASSERT_EQ(scene.lights().size(), 5u);
  EXPECT_TRUE(std::holds_alternative<lights::AreaLight>(scene.lights()[1]));
  EXPECT_TRUE(std::holds_alternative<lights::PointLight>(scene.lights()[2]));
  EXPECT_TRUE(std::holds_alternative<lights::DirectionalLight>(scene.lights()[3]));
  EXPECT_EQ(scene.environment_light(), 4u);
  const lights::LightSampleContext point{{0, 0.5f, 0}, {}};
  const lights::LightSampler sampler(scene.lights(), lights::LightSampler::Among::kDelta, 1);
  for (const std::uint32_t light : {0u, 1u, 4u}) EXPECT_EQ(sampler.pmf(point, light), 0);
  EXPECT_NEAR(sampler.pmf(point, 2) + sampler.pmf(point, 3), 1, 1e-6);
}

TEST(Scene, WeighsTexturedLampsByTheirMean) {
  test::SceneMaker maker({});
  const TextureImage image{2, 2, std::vector<float>{4, 4, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0}};
  maker.description().textures = {{.image = std::make_shared<TextureImage>(image)}};
  const auto screen = maker.material(test::lambert(0));
  maker.description().materials[screen].emission = {Rgb::gray(3), 0};
  const auto lamp = maker.material(test::lambert(0), Rgb::gray(3));
  for (const auto material : {screen, lamp})
    maker.add(QuadDescription{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, material});
  const Scene scene = maker.build();
  const lights::LightSampleContext point{{0.3f, 0.4f, 1}, {}};
  const lights::LightSampler sampler(scene.lights(), lights::LightSampler::Among::kAll, 1);
  EXPECT_NEAR(sampler.pmf(point, 0), sampler.pmf(point, 1), 1e-6);
}

// Edges whose squares do not fit a float.
TEST(Scene, FindsLightsOfAnySize) {
  for (const float size : {1e-12f, 1e10f}) {
    test::SceneMaker maker({});
    const auto lamp = maker.material(test::lambert(0), Rgb::gray(3));
    maker.add(MeshDescription{.positions = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}},
                              .normals = {},
                              .uvs = {},
                              .triangles = {{0, 1, 2}},
                              .triangle_materials = {lamp}});
    EXPECT_EQ(maker.build().lights().size(), 1u) << size;
  }
}

TEST(Scene, RefusesLightTooBrightToBeComputed) {
  const TextureImage image{1, 1, std::vector<float>{1e30f, 1, 1}};
  SceneDescription description = test::room();
  description.textures = {{.image = std::make_shared<TextureImage>(image)}};
  description.environment = {{Rgb::gray(1e20f), 0}};
  EXPECT_THAT(error_of(description),
              testing::HasSubstr("environment: radiance times its image is too bright"));
  description.environment.reset();
  description.materials[0].emission = {Rgb::gray(1e20f), 0};
  EXPECT_THAT(error_of(description), testing::HasSubstr("emission times its texture is too bright"));
}

TEST(Scene, CanBeEmpty) {
  SceneDescription description = test::room();
  description.shapes.clear();
  EXPECT_TRUE(Scene::build(description, 1).has_value());
}

TEST(Scene, RefusesWhatCannotBeRendered) {
  using testing::HasSubstr;
  MeshDescription mesh = triangle();
  mesh.positions[1].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(error_of(with(mesh)), HasSubstr("shapes[0]: vertex 2: coordinates must be numbers"));
  mesh = triangle();
  mesh.triangles[0][2] = 3;
  EXPECT_THAT(error_of(with(mesh)), HasSubstr("triangle 1: there is no vertex 4"));
  mesh = triangle();
  mesh.normals = {{0, 0, 1}};
  EXPECT_THAT(error_of(with(mesh)), HasSubstr("1 normals for 3 vertices"));
  EXPECT_THAT(error_of(with(SphereDescription{{0, 0, 0}, -1, 0})), HasSubstr("radius above 0"));
  EXPECT_THAT(error_of(with(QuadDescription{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 99})),
              HasSubstr("there is no material 99"));
  EXPECT_THAT(error_of(with(QuadDescription{{1e30f, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0})),
              HasSubstr("at most 1e"));

  SceneDescription description = test::room();
  description.settings.width_px = 0;
  EXPECT_THAT(error_of(description), HasSubstr("render: width: must be between 1 and 65536 pixels, got 0"));
  description = test::room();
  description.camera.look_at = description.camera.position;
  EXPECT_THAT(error_of(description), HasSubstr("camera.look_at: must differ"));
  description = test::room();
  description.camera.up = {0, 0, 1};
  EXPECT_THAT(error_of(description), HasSubstr("camera.up"));
  description = test::room();
  description.lights = {PointLightDescription{{0, 0, 0}, Rgb::gray(-1)}};
  EXPECT_THAT(error_of(description), HasSubstr("lights[0]: intensity must be 0 or greater, got ["));
  description.lights = {SpotLightDescription{.position = {1, 0, 0}, .look_at = {1, 0, 0}, .intensity = {}}};
  EXPECT_THAT(error_of(description), HasSubstr("lights[0]: position and look_at must be two points"));
  description.lights = {DirectionalLightDescription{{0, 0, 0}, Rgb::gray(1)}};
  EXPECT_THAT(error_of(description), HasSubstr("lights[0]: direction must have a length"));
  description = test::room();
  description.environment = {{Rgb::gray(1), 3}};
  EXPECT_THAT(error_of(description), HasSubstr("environment: texture: there is no such texture"));
  description = test::room();
  description.materials[0].emission.texture = 7;
  EXPECT_THAT(error_of(description), HasSubstr("material 'm0': emission: there is no such texture"));
  description = test::room();
  description.materials[0].emission.value.g = -1;
  EXPECT_THAT(error_of(description), HasSubstr("material 'm0': emission"));
}

// What a window may be, and what is said of one that may not.
TEST(RenderSettings, TakeAnyWindowWithinTheImage) {
  const RenderSettings from_scene{.width_px = 640, .height_px = 480};
  EXPECT_EQ(from_scene.window(), (PixelRect{0, 0, 640, 480}));
  for (const PixelRect& window : {PixelRect{0, 0, 640, 480}, {639, 479, 640, 480}, {10, 20, 30, 40}}) {
    const auto settings = resolve_settings(from_scene, {.crop = window});
    ASSERT_TRUE(settings);
    EXPECT_EQ(settings->window(), window);
  }
  for (const PixelRect& window : {PixelRect{0, 0, 641, 480},
                                  {0, 0, 640, 481},
                                  {-1, 0, 5, 5},
                                  {0, -1, 5, 5},
                                  {5, 0, 5, 9},
                                  {0, 9, 5, 3}}) {
    const auto settings = resolve_settings(from_scene, {.crop = window});
    ASSERT_FALSE(settings);
    EXPECT_EQ(settings.error().code, ErrorCode::kInvalidArgument);
    EXPECT_TRUE(settings.error().message.starts_with(
        "crop: must be x0, y0, x1, y1 with x0 < x1 and y0 < y1, within the 640 x 480 pixels of the image, "
        "got "))
        << settings.error().message;
  }
}

TEST(RenderSettings, KeepTheScenesWindowUnlessThereIsAnother) {
  const RenderSettings from_scene{.width_px = 640, .height_px = 480, .crop = PixelRect{600, 0, 640, 40}};
  EXPECT_EQ(resolve_settings(from_scene, {})->window(), (PixelRect{600, 0, 640, 40}));
  EXPECT_EQ(resolve_settings(from_scene, {.crop = PixelRect{0, 0, 8, 8}})->window(), (PixelRect{0, 0, 8, 8}));
  EXPECT_FALSE(resolve_settings(from_scene, {.width_px = 320})) << "it does not lie in the smaller image";
}

}  // namespace
}  // namespace tessera::core::integrators
