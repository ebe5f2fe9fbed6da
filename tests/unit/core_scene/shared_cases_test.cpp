// SPDX-License-Identifier: Apache-2.0
// Inputs that people met in the wild, where they are at hand: each is rendered.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "core/scene/loader/loader.hpp"
#include "core/scene/validation.hpp"

namespace tessera::core {
namespace {

namespace fs = std::filesystem;

const fs::path kFolder = TESSERA_SOURCE_DIR "/../shared/cases";

// By their number.
constexpr std::array kCases{"01", "02", "03", "05", "06", "08", "09",
                            "10", "11", "13", "15", "17", "18", "29"};

std::vector<fs::path> scenes_of(const std::string& number) {
  std::vector<fs::path> scenes;
  for (const auto& entry : fs::recursive_directory_iterator(kFolder))
    if (entry.path().extension() == ".json" &&
        fs::relative(entry.path(), kFolder).string().starts_with(number + "-"))
      scenes.push_back(entry.path());
  std::sort(scenes.begin(), scenes.end());
  return scenes;
}

class SharedCases : public testing::TestWithParam<const char*> {};

TEST_P(SharedCases, AreRead) {
  if (!fs::exists(kFolder)) GTEST_SKIP() << kFolder << " is not there";
  const auto scenes = scenes_of(GetParam());
  ASSERT_FALSE(scenes.empty());
  for (const fs::path& path : scenes) {
    const auto scene = load_scene_file(path.string());
    ASSERT_TRUE(scene.has_value()) << path << ": " << scene.error().message;
    EXPECT_TRUE(validate_scene(*scene).has_value()) << path;
  }
}

INSTANTIATE_TEST_SUITE_P(Numbers, SharedCases, testing::ValuesIn(kCases));

}  // namespace
}  // namespace tessera::core
