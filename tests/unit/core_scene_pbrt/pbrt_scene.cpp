// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/core_scene_pbrt/pbrt_scene.hpp"

#include <gtest/gtest.h>

#include "core/scene/validation.hpp"

namespace tessera::core::test {

Result<SceneDescription> load_pbrt(const std::string& scene, const MemoryAssets::Files& files) {
  MemoryAssets::Files all = files;
  all["scene.pbrt"] = scene;
  MemoryAssets assets(all);
  return load_scene(assets, "scene.pbrt", "scene.pbrt");
}

SceneDescription pbrt_scene(const std::string& scene, const MemoryAssets::Files& files) {
  auto loaded = load_pbrt(scene, files);
  EXPECT_TRUE(loaded) << loaded.error().message;
  if (!loaded) return {};
  const Status valid = validate_scene(*loaded);
  EXPECT_TRUE(valid) << valid.error().message;
  return std::move(*loaded);
}

SceneDescription pbrt_world(const std::string& world, const MemoryAssets::Files& files) {
  return pbrt_scene("Camera \"perspective\" WorldBegin\n" + world, files);
}

std::string pbrt_error(const std::string& scene, const MemoryAssets::Files& files) {
  const auto loaded = load_pbrt(scene, files);
  return loaded ? "no error" : loaded.error().message;
}

void expect_color(Rgb color, Rgb expected, float tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(color[c], expected[c], tolerance) << "channel " << c;
}

std::string warnings_of(const SceneDescription& scene) {
  std::string all;
  for (const std::string& warning : scene.warnings) all += warning + "\n";
  return all;
}

Material pbrt_material(const std::string& directives, const MemoryAssets::Files& files) {
  const SceneDescription scene = pbrt_world(directives + "\n" + kPbrtTriangle, files);
  const auto* mesh = scene.shapes.empty() ? nullptr : std::get_if<MeshDescription>(&scene.shapes.front());
  EXPECT_NE(mesh, nullptr);
  return mesh == nullptr ? Material() : scene.materials.at(mesh->triangle_materials.at(0));
}

}  // namespace tessera::core::test
