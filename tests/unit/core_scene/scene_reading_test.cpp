// SPDX-License-Identifier: Apache-2.0
// What good scene files turn into.
#include <gtest/gtest.h>

#include <utility>

#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core {
namespace {

using test::load_valid;
using test::scene_with;

TEST(SceneReading, HasSensibleDefaults) {
  const SceneDescription scene = load_valid(scene_with("", "\"m\": {\"type\": \"lambert\"}", ""));
  EXPECT_EQ(scene.settings, RenderSettings{});
  EXPECT_EQ(scene.camera.position, (Vec3{0, 0, 5}));
  EXPECT_EQ(scene.camera.up, (Vec3{0, 1, 0}));
  EXPECT_EQ(scene.camera.vertical_fov_degrees, 40);
  EXPECT_EQ(scene.camera.aperture_radius, 0);
  EXPECT_EQ(scene.camera.focus_distance, 0);
  EXPECT_EQ(scene.camera.aperture_blades, 0);
  EXPECT_EQ(scene.camera.aperture_rotation_degrees, 0);
  EXPECT_EQ(scene.display, DisplaySettings{});
  ASSERT_EQ(scene.materials.size(), 2u);
  EXPECT_EQ(std::get<Lambert>(scene.materials[0].model).albedo.value, Rgb::gray(0.5f));
  EXPECT_TRUE(is_black(scene.materials[0].emission.value));
  EXPECT_TRUE(scene.materials[1].two_sided_emission);
  ASSERT_EQ(scene.shapes.size(), 1u);
  EXPECT_EQ(std::get<SphereDescription>(scene.shapes[0]).center, (Vec3{0, 0, 0}));
}

TEST(SceneReading, FiltersHaveRadiiThatSuitThem) {
  const auto filter_of = [](const std::string& render) {
    return load_valid(scene_with("\"render\": {" + render + "}", "", "")).settings.filter;
  };
  EXPECT_EQ(filter_of(""), (PixelFilter{FilterKind::kBox, 0.5f}));
  EXPECT_EQ(filter_of("\"filter\": \"tent\""), (PixelFilter{FilterKind::kTent, 1}));
  EXPECT_EQ(filter_of("\"filter\": \"gaussian\""), (PixelFilter{FilterKind::kGaussian, 1.5f}));
  EXPECT_EQ(filter_of("\"filter_radius\": 1"), (PixelFilter{FilterKind::kBox, 1}));
}

TEST(SceneReading, TakesEverySetting) {
  const SceneDescription scene = load_valid(
      "// A comment\n{\"$schema\": \"../scene.schema.json\", /* another */\n"
      "\"render\": {\"width\": 640, \"height\": 480, \"spp\": 16777216, \"seed\": 18446744073709551615,"
      "\"integrator\": \"nee\", \"heuristic\": \"power\", \"max_depth\": 7, \"filter\": \"gaussian\","
      "\"filter_radius\": 2.25, \"crop\": [0, 8, 640, 479], \"clamp_indirect\": 12.5},"
      "\"camera\": {\"position\": [1, 2, 3], \"look_at\": [4.5, 5, -6e1], \"up\": [0, 0, 1],"
      "\"vertical_fov_degrees\": 33.5, \"aperture_radius\": 0.25, \"focus_distance\": 9,"
      "\"aperture_blades\": 7, \"aperture_rotation_degrees\": -12.5},"
      "\"output\": {\"exposure\": -1.5, \"tone_curve\": \"agx\"},"
      "\"materials\": {\"l\": {\"type\": \"mirror\", \"emission\": [1, 2, 3], \"emission_sides\": "
      "\"front\"}},"
      "\"shapes\": [{\"type\": \"sphere\", \"center\": [1, 2, 3], \"radius\": 0.5, \"material\": \"l\"}]}");
  EXPECT_EQ(scene.settings, (RenderSettings{.width_px = 640,
                                            .height_px = 480,
                                            .spp = 1u << 24,
                                            .seed = ~std::uint64_t{0},
                                            .integrator = Integrator::kNee,
                                            .heuristic = Heuristic::kPower,
                                            .max_depth = 7,
                                            .clamp_indirect = 12.5f,
                                            .filter = {FilterKind::kGaussian, 2.25f},
                                            .crop = PixelRect{0, 8, 640, 479}}));
  EXPECT_EQ(scene.camera.look_at, (Vec3{4.5f, 5, -60}));
  EXPECT_EQ(scene.camera.up, (Vec3{0, 0, 1}));
  EXPECT_EQ(scene.camera.vertical_fov_degrees, 33.5f);
  EXPECT_EQ(scene.camera.aperture_radius, 0.25f);
  EXPECT_EQ(scene.camera.focus_distance, 9);
  EXPECT_EQ(scene.camera.aperture_blades, 7);
  EXPECT_EQ(scene.camera.aperture_rotation_degrees, -12.5f);
  EXPECT_EQ(scene.display, (DisplaySettings{-1.5f, ToneCurve::kAgx}));
  EXPECT_EQ(scene.materials[0].name, "l");
  EXPECT_EQ(scene.materials[0].emission.value, (Rgb{1, 2, 3}));
  EXPECT_FALSE(scene.materials[0].two_sided_emission);
  EXPECT_EQ(std::get<SphereDescription>(scene.shapes[0]).radius, 0.5f);
  EXPECT_EQ(scene.shape_names, (std::vector<std::string>{"shapes[0]"}));
}

TEST(SceneReading, TakesTheWordsOfEveryIntegrator) {
  for (const auto& [name, integrator] : {std::pair{"naive", Integrator::kNaive},
                                         {"nee", Integrator::kNee},
                                         {"mis", Integrator::kMis},
                                         {"whitted", Integrator::kWhitted}})
    EXPECT_EQ(load_valid(scene_with("\"render\": {\"integrator\": \"" + std::string(name) + "\"}", "", ""))
                  .settings.integrator,
              integrator);
}

TEST(SceneReading, TakesLightsAndSurroundings) {
  const SceneDescription scene = load_valid(scene_with(
      "\"textures\": {\"sky\": {\"file\": \"gray.png\"}},"
      "\"lights\": [{\"type\": \"point\", \"position\": [1, 2, 3], \"intensity\": 5},"
      "{\"type\": \"spot\", \"position\": [0, 4, 0], \"look_at\": [0, 0, 1], \"intensity\": [1, 2, 3],"
      "\"angle_degrees\": 60, \"softness\": 0.5},"
      "{\"type\": \"directional\", \"direction\": [0, -2, 0], \"irradiance\": 1e3}],"
      "\"environment\": {\"radiance\": [3, 2, 1], \"texture\": \"sky\", \"rotation_degrees\": -90}",
      "", ""));
  ASSERT_EQ(scene.lights.size(), 3u);
  const auto& point = std::get<PointLightDescription>(scene.lights[0]);
  EXPECT_EQ(point.position, (Vec3{1, 2, 3}));
  EXPECT_EQ(point.intensity, Rgb::gray(5));
  const auto& spot = std::get<SpotLightDescription>(scene.lights[1]);
  EXPECT_EQ(spot.position, (Vec3{0, 4, 0}));
  EXPECT_EQ(spot.look_at, (Vec3{0, 0, 1}));
  EXPECT_EQ(spot.intensity, (Rgb{1, 2, 3}));
  EXPECT_EQ(spot.angle_degrees, 60);
  EXPECT_EQ(spot.softness, 0.5f);
  const auto& directional = std::get<DirectionalLightDescription>(scene.lights[2]);
  EXPECT_EQ(directional.direction, (Vec3{0, -2, 0}));
  EXPECT_EQ(directional.irradiance, Rgb::gray(1e3f));
  ASSERT_TRUE(scene.environment);
  EXPECT_EQ(scene.environment->radiance.value, (Rgb{3, 2, 1}));
  EXPECT_EQ(scene.environment->radiance.texture, 0);
  EXPECT_EQ(scene.environment->rotation_degrees, -90);
}

TEST(SceneReading, TakesTheTypesOfCameras) {
  const auto camera = [](const std::string& keys) {
    return load_valid("{\"camera\": {\"position\": [0, 0, 5], \"look_at\": [0, 0, 0], " + keys +
                      "}, \"materials\": {\"l\": {\"type\": \"lambert\", \"emission\": 1}}, "
                      "\"shapes\": [{\"type\": \"sphere\", \"radius\": 1, \"material\": \"l\"}]}")
        .camera;
  };
  EXPECT_EQ(camera("\"type\": \"panoramic\"").type, CameraType::kPanoramic);
  EXPECT_TRUE(camera("\"mirror\": true").mirrored);
  EXPECT_EQ(camera("\"lens_shift\": [0.5, -1]").lens_shift, (Vec2{0.5f, -1}));
  const CameraDescription flat = camera("\"type\": \"orthographic\", \"view_height\": 7");
  EXPECT_EQ(flat.type, CameraType::kOrthographic);
  EXPECT_EQ(flat.view_height, 7);
}

TEST(SceneReading, TurnsAndHidesTheEnvironment) {
  const SceneDescription scene =
      load_valid(scene_with("\"environment\": {\"visible_to_camera\": false, \"orientation\": [{\"matrix\": "
                            "[[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 0]]}]}",
                            "", ""));
  EXPECT_FALSE(scene.environment->visible_to_camera);
  EXPECT_EQ(scene.environment->orientation.x_axis, (Vec3{0, 1, 0}));
  EXPECT_EQ(test::mistakes_in(scene_with("\"environment\": {\"orientation\": [{\"scale\": 2}]}", "", "")),
            "scene.json:2: environment.orientation: the steps together must be a rotation or a reflection, "
            "which keep all lengths");
}

}  // namespace
}  // namespace tessera::core
