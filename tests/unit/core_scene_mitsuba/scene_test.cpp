// SPDX-License-Identifier: Apache-2.0
// Sensors, films, integrators and emitters of Mitsuba scenes.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "core/lights/equirectangular.hpp"
#include "core/scene/loader/asset_source.hpp"
#include "tests/unit/core_scene_mitsuba/mitsuba_scene.hpp"

namespace tessera::core::test {
namespace {

using testing::HasSubstr;

SceneDescription with_sensor(const std::string& inside, const std::string& type = "perspective") {
  return scene_of("<sensor type=\"" + type + "\">" + inside + "</sensor>");
}

constexpr const char* kSquareFilm =
    "<film type=\"hdrfilm\"><integer name=\"width\" value=\"200\"/><integer name=\"height\" "
    "value=\"100\"/></film>";

TEST(MitsubaSensor, LooksAlongItsZ) {
  const CameraDescription camera =
      with_sensor(
          "<transform name=\"to_world\"><lookat origin=\"1,2,3\" target=\"1,2,8\" up=\"0,1,0\"/></transform>")
          .camera;
  EXPECT_EQ(camera.position, (Vec3{1, 2, 3}));
  EXPECT_EQ(camera.look_at, (Vec3{1, 2, 4}));
  EXPECT_EQ(camera.up, (Vec3{0, 1, 0}));
}

TEST(MitsubaSensor, FieldOfViewIsThatOfItsAxis) {
  const auto vertical = [](const std::string& parameters) {
    return with_sensor(parameters + kSquareFilm).camera.vertical_fov_degrees;
  };
  EXPECT_NEAR(vertical("<float name=\"fov\" value=\"90\"/>"), 2 * std::atan(0.5) * 180 / std::numbers::pi,
              1e-3);
  EXPECT_NEAR(vertical("<float name=\"fov\" value=\"90\"/><string name=\"fov_axis\" value=\"y\"/>"), 90,
              1e-3);
  EXPECT_NEAR(vertical("<float name=\"fov\" value=\"90\"/><string name=\"fov_axis\" value=\"smaller\"/>"), 90,
              1e-3);
  // 50 mm: half of the diagonal of 36 x 24 mm, for an image that is twice as wide as high.
  const double tangent = std::sqrt(36.0 * 36 + 24 * 24) / 100 / std::sqrt(5.0);
  EXPECT_NEAR(vertical(""), 2 * std::atan(tangent) * 180 / std::numbers::pi, 1e-3);
}

TEST(MitsubaSensor, OrthographicCamerasHaveTheScaleOfTheirTransform) {
  const CameraDescription camera =
      with_sensor(
          std::string("<transform name=\"to_world\"><scale x=\"3\" y=\"3\"/></transform>") + kSquareFilm,
          "orthographic")
          .camera;
  EXPECT_EQ(camera.type, CameraType::kOrthographic);
  EXPECT_NEAR(camera.view_height, 3, 1e-6);
}

TEST(MitsubaSensor, FilmAndSamplerBecomeSettings) {
  const RenderSettings settings =
      with_sensor(
          "<film type=\"hdrfilm\"><rfilter type=\"tent\"/><integer name=\"width\" value=\"20\"/>"
          "<integer name=\"height\" value=\"10\"/><integer name=\"crop_offset_x\" value=\"5\"/>"
          "<integer name=\"crop_width\" value=\"7\"/></film>"
          "<sampler type=\"independent\"><integer name=\"sample_count\" value=\"33\"/></sampler>")
          .settings;
  EXPECT_EQ(settings.spp, 33u);
  EXPECT_EQ(settings.filter, (PixelFilter{FilterKind::kTent, 1}));
  EXPECT_EQ(settings.crop, (PixelRect{5, 0, 12, 10}));
  EXPECT_EQ(with_sensor(kSquareFilm).settings.filter, (PixelFilter{FilterKind::kGaussian, 1.5f}));
}

TEST(MitsubaIntegrator, DepthCountsTheCamerasSegment) {
  const auto depth = [](const std::string& type, const std::string& written) {
    const std::string parameter =
        written.empty() ? "" : "<integer name=\"max_depth\" value=\"" + written + "\"/>";
    return scene_of("<integrator type=\"moment\"><integrator type=\"" + type + "\">" + parameter +
                    "</integrator></integrator>")
        .settings.max_depth;
  };
  EXPECT_EQ(depth("path", ""), 0);
  EXPECT_EQ(depth("path", "-1"), 0);
  EXPECT_EQ(depth("path", "2"), 1);
  EXPECT_EQ(depth("volpath", "6"), 5);
  EXPECT_EQ(depth("direct", ""), 1);
}

TEST(MitsubaEmitter, LightsWithoutExtent) {
  const SceneDescription scene = scene_of(
      "<emitter type=\"point\"><transform name=\"to_world\"><translate z=\"2\"/></transform>"
      "<rgb name=\"intensity\" value=\"1 2 3\"/></emitter>"
      "<emitter type=\"spot\"><transform name=\"to_world\"><lookat origin=\"0,5,0\" "
      "target=\"0,0,0\"/></transform>"
      "<float name=\"cutoff_angle\" value=\"40\"/><float name=\"beam_width\" value=\"10\"/></emitter>"
      "<emitter type=\"directional\"><vector name=\"direction\" value=\"0,0,-1\"/>"
      "<spectrum name=\"irradiance\" value=\"4\"/></emitter>");
  ASSERT_EQ(scene.lights.size(), 3u);
  const auto& point = std::get<PointLightDescription>(scene.lights[0]);
  EXPECT_EQ(point.position, (Vec3{0, 0, 2}));
  EXPECT_EQ(point.intensity, (Rgb{1, 2, 3}));
  const auto& spot = std::get<SpotLightDescription>(scene.lights[1]);
  EXPECT_EQ(spot.position, (Vec3{0, 5, 0}));
  EXPECT_EQ(spot.look_at, (Vec3{0, 4, 0}));
  EXPECT_EQ(spot.angle_degrees, 80);
  EXPECT_EQ(spot.softness, 0.75f);
  const auto& sun = std::get<DirectionalLightDescription>(scene.lights[2]);
  EXPECT_EQ(sun.direction, (Vec3{0, 0, -1}));
  EXPECT_EQ(sun.irradiance, Rgb::gray(4));
}

TEST(MitsubaEmitter, EnvironmentMapsHaveTheirEdgeAtMinusZ) {
  const SceneDescription scene = scene_of(
      "<emitter type=\"envmap\"><string name=\"filename\" value=\"sky.hdr\"/>"
      "<float name=\"scale\" value=\"2\"/></emitter>",
      {{"sky.hdr", hdr(one_color(8, 4, Rgb::gray(1)))}});
  ASSERT_TRUE(scene.environment);
  EXPECT_EQ(scene.environment->radiance.value, Rgb::gray(2));
  const EquirectangularMap map(scene.environment->rotation_degrees);
  EXPECT_NEAR(map.uv_of(Vec3{1, 0, -1e-3f}).x, 0.25, 1e-3);
  EXPECT_NEAR(map.uv_of(Vec3{0, 0, 1}).x, 0.5, 1e-3);
}

TEST(MitsubaEmitter, SamplesAreIntegratedWithoutAnIlluminant) {
  const auto intensity = [](const std::string& samples) {
    const SceneDescription scene = scene_of("<emitter type=\"point\"><spectrum name=\"intensity\" value=\"" +
                                            samples + "\"/></emitter>");
    return std::get<PointLightDescription>(scene.lights.at(0)).intensity;
  };
  // Light of equal energy is redder than D65, the white of Rec. 709, and has the luminance 1.
  const Rgb equal = intensity("360:1, 830:1");
  EXPECT_NEAR(luminance(equal), 1, 2e-3);
  EXPECT_NEAR(equal.r, 1.2048, 2e-3);
  EXPECT_NEAR(equal.g, 0.9483, 2e-3);
  EXPECT_NEAR(equal.b, 0.9087, 2e-3);
  EXPECT_EQ(intensity("830:1, 360:1"), equal);
}

// Public scenes, where they are.
TEST(MitsubaCollection, RegressionTestsLoad) {
  const std::string folder = TESSERA_SOURCE_DIR "/../shared/data/scenes/mitsuba/tests/scenes/";
  for (const char* name :
       {"instancing/test_instancing_path.xml", "orthographic_sensor/test_orthographic_path.xml",
        "mesh_attributes/test_mesh_attributes_1_face_direct.xml",
        "participating_media/test_hetero_sigmat_volpath.xml"}) {
    if (!std::filesystem::exists(folder + name)) GTEST_SKIP() << folder << " is not here";
    const auto scene = load_scene_file(folder + name);
    EXPECT_TRUE(scene) << name << ": " << scene.error().message;
  }
}

}  // namespace
}  // namespace tessera::core::test
