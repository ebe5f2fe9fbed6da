// SPDX-License-Identifier: Apache-2.0
// For tests of what is said about mistakes in scene files: scenes with one place to make them, and lists of
// mistakes with the sentences.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core::test {

struct Mistake {
  std::string text, message;
};

// Where the text stands in a scene of scene_with, and thus its line.
inline std::string with_render(const std::string& render) {
  return scene_with("\"render\": {" + render + "}", "", "");
}
inline std::string with_textures(const std::string& textures) {
  return scene_with("\"textures\": {" + textures + "}", "", "");
}
inline std::string with_materials(const std::string& materials) {
  return scene_with("", materials, "");
}
inline std::string with_shapes(const std::string& shapes) {
  return scene_with("", "", shapes);
}
inline std::string with_camera(const std::string& camera) {
  return "{\"materials\": {\"l\": {\"type\": \"lambert\", \"emission\": 1}},\n\"camera\": {" + camera +
         "},\n\"shapes\": [{\"type\": \"sphere\", \"radius\": 1, \"material\": \"l\"}]}";
}

inline void expect_mistakes(const std::vector<Mistake>& cases, std::string (*scene)(const std::string&),
                            int line) {
  for (const auto& [text, message] : cases)
    EXPECT_EQ(mistakes_in(scene(text)), "scene.json:" + std::to_string(line) + ": " + message) << text;
}

}  // namespace tessera::core::test
