// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/core_scene_mitsuba/mitsuba_scene.hpp"

namespace tessera::core::test {

Result<SceneDescription> load_xml(const std::string& text, const MemoryAssets::Files& files) {
  MemoryAssets::Files all = files;
  all.emplace("scene.xml", text);
  MemoryAssets assets(std::move(all));
  return load_scene(assets, "scene.xml", "scene.xml");
}

std::string xml_scene(const std::string& content, bool with_sphere) {
  const std::string sphere = with_sphere ? "\n<shape type=\"sphere\"/>" : "";
  return "<scene version=\"3.0.0\">\n" + content + sphere + "\n</scene>\n";
}

SceneDescription scene_of(const std::string& content, const MemoryAssets::Files& files) {
  auto scene = load_xml(xml_scene(content), files);
  EXPECT_TRUE(scene) << scene.error().message;
  return scene ? std::move(*scene) : SceneDescription{};
}

std::string error_of(const std::string& content, const MemoryAssets::Files& files) {
  const auto scene = load_xml(xml_scene(content), files);
  return scene ? "no error" : scene.error().message;
}

std::string warnings_of(const SceneDescription& scene) {
  std::string all;
  for (const std::string& warning : scene.warnings) all += warning + "\n";
  return all;
}

Material material_of(const std::string& inside, const MemoryAssets::Files& files) {
  const auto scene = load_xml(xml_scene("<shape type=\"sphere\">" + inside + "</shape>", false), files);
  EXPECT_TRUE(scene) << scene.error().message;
  if (!scene || scene->shapes.empty()) return {};
  const auto* sphere = std::get_if<SphereDescription>(&scene->shapes.front());
  EXPECT_NE(sphere, nullptr);
  return sphere == nullptr ? Material{} : scene->materials[sphere->material];
}

}  // namespace tessera::core::test
