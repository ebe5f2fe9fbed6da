// SPDX-License-Identifier: Apache-2.0
// What docs/scene-format.md shows must be true.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core {
namespace {

std::string documentation() {
  std::ifstream file(TESSERA_SOURCE_DIR "/docs/scene-format.md");
  return {std::istreambuf_iterator<char>(file), {}};
}

// The first block of `text` in the given language.
std::string code_block(const std::string& text, const std::string& language) {
  const std::string fence = "```" + language + "\n";
  const std::size_t begin = text.find(fence) + fence.size();
  return text.substr(begin, text.find("```", begin) - begin);
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  EXPECT_NE(text.find(from), std::string::npos) << from;
  return text.replace(text.find(from), from.size(), to);
}

TEST(Documentation, BeginsWithASceneThatLoads) {
  EXPECT_EQ(test::mistakes_in(code_block(documentation(), "jsonc")), "no mistake");
}

TEST(Documentation, ShowsTheMessagesThatMistakesGet) {
  const std::string scene = code_block(documentation(), "jsonc");
  const std::string wrong = replaced(replaced(scene, "reflectance", "reflectence"), "\"material\": \"floor\"",
                                     "\"material\": \"flor\"");
  std::string message = test::mistakes_in(wrong) + "\n";
  for (int i = 0; i < 2; ++i) message = replaced(message, "scene.json", "first.json");
  EXPECT_NE(documentation().find("```\n" + message + "```"), std::string::npos) << message;
}

}  // namespace
}  // namespace tessera::core
