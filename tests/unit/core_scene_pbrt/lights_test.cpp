// SPDX-License-Identifier: Apache-2.0
// Light sources of pbrt files, with the scales that the format defines.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "core/lights/equirectangular.hpp"
#include "core/scene/pbrt/environment_map.hpp"
#include "tests/unit/core_scene_pbrt/pbrt_scene.hpp"

namespace tessera::core::test {
namespace {

using testing::HasSubstr;

constexpr float kPiF = std::numbers::pi_v<float>;

template <typename Light>
Light light_of(const std::string& directive) {
  const SceneDescription scene = pbrt_world(directive + " Shape \"sphere\"");
  const auto* light = scene.lights.empty() ? nullptr : std::get_if<Light>(&scene.lights.front());
  EXPECT_NE(light, nullptr) << directive;
  return light == nullptr ? Light{} : *light;
}

TEST(PbrtLights, PointLights) {
  const auto light = light_of<PointLightDescription>(
      "Translate 1 0 0 LightSource \"point\" \"point3 from\" [0 2 0] \"rgb I\" [1 2 3] \"float scale\" 2");
  EXPECT_EQ(light.position, (Vec3{1, 2, 0}));
  EXPECT_EQ(light.intensity, (Rgb{2, 4, 6}));
}

TEST(PbrtLights, PowerIsSpreadOverTheDirections) {
  expect_color(light_of<PointLightDescription>("LightSource \"point\" \"float power\" 100").intensity,
               Rgb::gray(100 / (4 * kPiF)));
  // A cone without falloff of 60 degrees to each side: pi steradian.
  expect_color(
      light_of<SpotLightDescription>("LightSource \"spot\" \"float power\" 100 \"float coneangle\" 60 "
                                     "\"float conedeltaangle\" 0")
          .intensity,
      Rgb::gray(100 / kPiF), 1e-3f);
}

TEST(PbrtLights, SpotLightsFallOffInTheirDelta) {
  const auto light = light_of<SpotLightDescription>(
      "LightSource \"spot\" \"point3 from\" [0 3 0] \"point3 to\" [0 0 0] \"float coneangle\" 40 "
      "\"float conedeltaangle\" 10");
  EXPECT_EQ(light.position, (Vec3{0, 3, 0}));
  EXPECT_EQ(light.look_at, (Vec3{0, 0, 0}));
  EXPECT_FLOAT_EQ(light.angle_degrees, 80);
  EXPECT_FLOAT_EQ(light.softness, 0.25f);
}

TEST(PbrtLights, ProjectionsOfFlatImagesAreLeftOut) {
  const SceneDescription scene =
      pbrt_world("AttributeBegin Scale 0 1 1 LightSource \"projection\" AttributeEnd Shape \"sphere\"");
  EXPECT_TRUE(scene.lights.empty());
}

TEST(PbrtLights, DistantLightsTravelFromTheirOrigin) {
  const auto light = light_of<DirectionalLightDescription>(
      "LightSource \"distant\" \"point3 from\" [0 5 0] \"point3 to\" [0 0 0] \"rgb L\" [2 2 2] "
      "\"float illuminance\" 3");
  EXPECT_EQ(light.direction, (Vec3{0, -1, 0}));
  EXPECT_EQ(light.irradiance, Rgb::gray(6));
}

TEST(PbrtLights, LightOfSpectraHasLuminanceOne) {
  for (const char* color : {"\"blackbody I\" 3000", "\"spectrum I\" [400 5 500 7 600 9 700 1]",
                            "\"spectrum I\" \"stdillum-A\"", "\"spectrum I\" \"stdillum-F11\""})
    EXPECT_NEAR(
        luminance(light_of<PointLightDescription>(std::string("LightSource \"point\" ") + color).intensity),
        1, 0.01)
        << color;
  expect_color(
      light_of<PointLightDescription>("LightSource \"point\" \"spectrum I\" \"stdillum-D65\"").intensity,
      Rgb::gray(1), 0.005f);
}

TEST(PbrtLights, AreaLightsEmitToTheirFront) {
  const Material one = pbrt_material("AreaLightSource \"diffuse\" \"rgb L\" [1 2 3] \"float scale\" 2");
  EXPECT_EQ(one.emission.value, (Rgb{2, 4, 6}));
  EXPECT_FALSE(one.two_sided_emission);
  EXPECT_TRUE(pbrt_material("AreaLightSource \"diffuse\" \"bool twosided\" true").two_sided_emission);
}

TEST(PbrtLights, PowerOfAreaLights) {
  // The triangle has the area 1/2.
  expect_color(pbrt_material("AreaLightSource \"diffuse\" \"float power\" 10").emission.value,
               Rgb::gray(10 / (kPiF * 0.5f)));
  const SceneDescription scene =
      pbrt_world("AreaLightSource \"diffuse\" \"float power\" 10 Shape \"sphere\"");
  expect_color(scene.materials.at(0).emission.value, Rgb::gray(10 / (4 * kPiF * kPiF)));
}

TEST(PbrtLights, ShapesOfObjectsDoNotEmit) {
  const SceneDescription scene = pbrt_world(
      "ObjectBegin \"a\" AreaLightSource \"diffuse\" Shape \"sphere\" ObjectEnd ObjectInstance \"a\"");
  EXPECT_EQ(scene.materials.at(0).emission.value, Rgb{});
  EXPECT_THAT(warnings_of(scene), HasSubstr("shapes of objects do not emit"));
}

TEST(PbrtLights, InfiniteLightsAddUp) {
  const SceneDescription scene = pbrt_world(
      "LightSource \"infinite\" \"rgb L\" [1 0 0] LightSource \"infinite\" \"float illuminance\" 3 Shape "
      "\"sphere\"");
  ASSERT_TRUE(scene.environment);
  EXPECT_LT(scene.environment->radiance.texture, 0);
  expect_color(scene.environment->radiance.value, Rgb{1 + 3 / kPiF, 3 / kPiF, 3 / kPiF});
}

TEST(PbrtLights, ASceneWithoutLightIsBlack) {
  const SceneDescription scene = pbrt_world("Shape \"sphere\"");
  EXPECT_FALSE(scene.environment);
  EXPECT_TRUE(scene.lights.empty());
}

// Red on the left and green on the right, seen from the light.
std::string two_colors() {
  Image image(2, 1);
  image.at(0, 0) = {2, 0, 0};
  image.at(1, 0) = {0, 1, 0};
  return hdr(image);
}

TEST(PbrtLights, ProjectionsShowTheirImage) {
  const SceneDescription scene = pbrt_world(
      "LightSource \"projection\" \"string filename\" \"slide.hdr\" \"float fov\" 90 \"float scale\" 3\n"
      "Shape \"sphere\"",
      {{"slide.hdr", two_colors()}});
  const auto& light = std::get<SpotLightDescription>(scene.lights.at(0));
  EXPECT_EQ(light.look_at - light.position, (Vec3{0, 0, 1}));
  expect_color(light.intensity, Rgb::gray(3), 1e-4f);
  EXPECT_NEAR(light.image.right.x, 2, 1e-5f);
  EXPECT_NEAR(light.image.up.y, 1, 1e-5f);
  EXPECT_FALSE(light.image.flat_field);
  EXPECT_NEAR(light.angle_degrees, 2 * 180 / kPiF * std::atan(std::sqrt(5.0f)), 0.1f);
  const Texture& slide = scene.textures.at(static_cast<std::size_t>(light.image.texture));
  EXPECT_GT(slide.evaluate({0.1f, 0.5f}).r, 1.5f);
  EXPECT_EQ(warnings_of(scene), "");
}

TEST(PbrtLights, ImagesOfAreaLightsEndAtTheirEdges) {
  const SceneDescription scene =
      pbrt_world("AreaLightSource \"diffuse\" \"string filename\" \"slide.hdr\" " + kPbrtTriangle,
                 {{"slide.hdr", two_colors()}});
  const int image = scene.materials.at(0).emission.texture;
  expect_color(scene.textures.at(static_cast<std::size_t>(image)).evaluate(Vec2{0.01f, 0.5f}), {2, 0, 0});
}

// The pole of the image's mapping is the light's y axis.
TEST(PbrtLights, GoniometricLightsEmitAsTheirImageSays) {
  Image image(16, 16);
  float sum = 0;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) {
      const float z = pbrt::equal_area_direction(
                          {(static_cast<float>(x) + 0.5f) / 16, (static_cast<float>(y) + 0.5f) / 16})
                          .z;
      image.at(x, y) = Rgb::gray(z > 0 ? 3.0f : 1.0f);
      sum += image.at(x, y).g;
    }
  const SceneDescription scene = pbrt_world(
      "LightSource \"goniometric\" \"string filename\" \"lamp.hdr\" \"float power\" 100\nShape \"sphere\"",
      {{"lamp.hdr", hdr(image)}});
  const auto& light = std::get<PointLightDescription>(scene.lights.at(0));
  expect_color(light.intensity, Rgb::gray(100 / (4 * kPiF * sum / (16 * 16))), 1e-3f);
  const auto& texture = scene.textures.at(static_cast<std::size_t>(light.texture));
  const lights::EquirectangularMap map(0, light.orientation);
  EXPECT_NEAR(texture.evaluate(map.uv_of(Vec3{0.3f, 0.8f, 0.2f})).g, 3, 1e-2f);
  EXPECT_NEAR(texture.evaluate(map.uv_of(Vec3{0.3f, -0.8f, 0.2f})).g, 1, 1e-2f);
}

TEST(PbrtLights, ApproximationsAreTold) {
  const std::string warnings = warnings_of(
      pbrt_world("LightSource \"goniometric\"\nLightSource \"projection\"\nLightSource \"candle\"\n"
                 "LightSource \"infinite\" \"string filename\" \"gone.exr\" \"point3 portal\" [0 0 0 1 0 0 1 "
                 "1 0 0 1 0]\n"
                 "Shape \"sphere\""));
  EXPECT_THAT(warnings, HasSubstr("scene.pbrt:3: a projection light without an image projects white"));
  EXPECT_THAT(warnings, HasSubstr("scene.pbrt:4: the light source 'candle' is not known"));
  EXPECT_THAT(warnings, HasSubstr("scene.pbrt:5: the image 'gone.exr' does not exist"));
  EXPECT_THAT(warnings, HasSubstr("scene.pbrt:5: the portal"));
}

// pbrt's lights without a material do not emit, and those whose alpha is 0 are not seen.
TEST(PbrtLights, WithoutASurface) {
  const SceneDescription open = pbrt_world(
      "AttributeBegin AreaLightSource \"diffuse\" Material \"interface\" Shape \"sphere\" "
      "AttributeEnd\n" +
      kPbrtTriangle);
  EXPECT_THAT(warnings_of(open),
              HasSubstr("an emitter whose material is \"interface\" does not emit, as in pbrt"));
  EXPECT_EQ(open.shapes.size(), 1u);
  const SceneDescription hidden =
      pbrt_world("AreaLightSource \"diffuse\" Shape \"sphere\" \"float alpha\" 0");
  EXPECT_THAT(warnings_of(hidden), HasSubstr("an emitter that is invisible is seen in mirrors"));
  ASSERT_EQ(hidden.materials.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<Null>(hidden.materials[0].model));
  EXPECT_FALSE(hidden.materials[0].visible_to_camera);
}

}  // namespace
}  // namespace tessera::core::test
