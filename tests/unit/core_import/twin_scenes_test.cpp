// SPDX-License-Identifier: Apache-2.0
// Scenes of other formats render to the same bytes as their twins in Tessera's own (tests/twins).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "core/integrators/render.hpp"
#include "core/scene/loader/loader.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core {
namespace {

// What a format does not have, and a scene takes from its twin here.
enum class Lack { kNothing, kSettings, kCameraAndLight };

struct TwinScene {
  const char* file;
  const char* twin;
  Lack lack = Lack::kNothing;
};

void PrintTo(const TwinScene& scene, std::ostream* out) {
  *out << scene.file;
}

SceneDescription loaded(const char* name) {
  auto scene = load_scene_file(std::string(TESSERA_TWINS_DIR "/") + name);
  EXPECT_TRUE(scene) << scene.error().message;
  return scene ? std::move(*scene) : SceneDescription{};
}

// Angles of other formats are converted by way of their tangents, which rounds.
void take_equal_angle(CameraDescription& camera, const CameraDescription& twin) {
  constexpr float kRoundingDegrees = 1e-4f;
  if (std::fabs(camera.vertical_fov_degrees - twin.vertical_fov_degrees) < kRoundingDegrees)
    camera.vertical_fov_degrees = twin.vertical_fov_degrees;
}

void take_camera_and_light(SceneDescription& mesh, const SceneDescription& twin) {
  mesh.camera = twin.camera;
  mesh.environment = twin.environment;
  mesh.lights = twin.lights;
  mesh.textures = twin.textures;
}

std::vector<std::uint64_t> rendered(SceneDescription description) {
  const auto scene = Scene::build(std::move(description), 1);
  EXPECT_TRUE(scene) << scene.error().message;
  if (!scene) return {};
  const RenderSettings& settings = scene->settings();
  return render(integrators::prepare(*scene, settings, 1), settings.window(), {0, settings.spp}, 1).sums;
}

class TwinScenes : public testing::TestWithParam<TwinScene> {};

TEST_P(TwinScenes, HaveTheSameBytes) {
  SceneDescription scene = loaded(GetParam().file), twin = loaded(GetParam().twin);
  if (GetParam().lack != Lack::kNothing) scene.settings = twin.settings;
  if (GetParam().lack == Lack::kCameraAndLight) take_camera_and_light(scene, twin);
  take_equal_angle(scene.camera, twin.camera);
  EXPECT_EQ(scene.camera.vertical_fov_degrees, twin.camera.vertical_fov_degrees);
  ASSERT_TRUE(scene.settings == twin.settings);
  const std::vector<std::uint64_t> imported = rendered(std::move(scene)), own = rendered(std::move(twin));
  EXPECT_EQ(imported, own);
  EXPECT_TRUE(std::any_of(own.begin(), own.end(), [](std::uint64_t sum) { return sum > 0; }));
}

constexpr std::array kScenes = std::to_array<TwinScene>({{"pyramids.gltf", "pyramids.json", Lack::kSettings},
                                                         {"materials.pbrt", "materials.json"},
                                                         {"materials.xml", "materials.json"},
                                                         {"patterns.pbrt", "patterns.json"},
                                                         {"sheets.pbrt", "sheets.json"},
                                                         {"lights.pbrt", "lights.json"},
                                                         {"lights.xml", "lights.json"},
                                                         {"instances.pbrt", "instances.json"},
                                                         {"instances.xml", "instances.json"},
                                                         {"media.pbrt", "media.json"},
                                                         {"media.xml", "media.json"},
                                                         {"lens.pbrt", "lens.json"},
                                                         {"lens.xml", "lens.json"},
                                                         {"orthographic.pbrt", "orthographic.json"},
                                                         {"orthographic.xml", "orthographic.json"},
                                                         {"panorama.pbrt", "panorama.json"},
                                                         {"solid.obj", "solid.json", Lack::kCameraAndLight},
                                                         {"solid.ply", "solid.json", Lack::kCameraAndLight},
                                                         {"solid.stl", "solid.json", Lack::kCameraAndLight}});

INSTANTIATE_TEST_SUITE_P(Files, TwinScenes, testing::ValuesIn(kScenes), [](const auto& scene) {
  std::string name = scene.param.file;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
});

}  // namespace
}  // namespace tessera::core
