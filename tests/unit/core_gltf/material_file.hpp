// SPDX-License-Identifier: Apache-2.0
// glTF files of one material, for tests.
#pragma once

#include <gtest/gtest.h>

#include <utility>

#include "core/image/encode.hpp"
#include "tests/unit/core_gltf/gltf_file.hpp"

namespace tessera::core::test {

// A file whose triangle has this material; its texture 0 is an image of 0.25, 0.5 and 0.75.
inline GltfFile file_with(const nlohmann::json& material) {
  GltfFile file;
  file.json["materials"].push_back(material);
  file.json["images"].push_back({{"uri", "image.png"}});
  file.json["textures"].push_back({{"source", 0}});
  file.node({{"mesh", file.triangle(0)}});
  return file;
}

inline Result<SceneDescription> load_file(const GltfFile& file) {
  Image image = one_color(2, 2, {0.25f, 0.5f, 0.75f});
  return load_gltf(file.text(), {{"image.png", png(image)}});
}

inline SceneDescription scene_of(const nlohmann::json& material) {
  auto scene = load_file(file_with(material));
  EXPECT_TRUE(scene) << scene.error().message;
  return scene ? std::move(*scene) : SceneDescription();
}

inline const Principled& model_of(const SceneDescription& scene, std::size_t material = 0) {
  return std::get<Principled>(scene.materials.at(material).model);
}

inline Rgb texture_value(const SceneDescription& scene, int texture) {
  return value_at(scene.textures.at(static_cast<std::size_t>(texture)), scene.textures, Vec2{0.5f, 0.5f});
}

inline nlohmann::json texture(int index = 0) {
  return {{"index", index}};
}
inline nlohmann::json extension(const char* name, const nlohmann::json& members) {
  return {{"extensions", {{name, members}}}};
}

}  // namespace tessera::core::test
