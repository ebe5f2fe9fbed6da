// SPDX-License-Identifier: Apache-2.0
#include "client/example_scenes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/temporary_folder.hpp"

namespace tessera::client {
namespace {

using testing::EndsWith;

TEST(ExampleScenes, AreFoundBesideTheProgramByTheirNames) {
  EXPECT_THAT(find_scene("cornell"), EndsWith("/share/tessera/scenes/cornell/scene.json"));
  EXPECT_THAT(find_scene("cook_torrance_sampling/uniform"),
              EndsWith("/scenes/cook_torrance_sampling/uniform.json"));
  EXPECT_TRUE(std::filesystem::exists(find_scene("cornell")));
}

TEST(ExampleScenes, OtherNamesStayAsTheyAre) {
  for (const char* name : {"", "none", "none.json", "/cornell", "../cornell/none"})
    EXPECT_EQ(find_scene(name), name);
}

TEST(ExampleScenes, FilesComeFirst) {
  const TemporaryFolder folder;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  std::ofstream("cornell") << "{}";
  EXPECT_EQ(find_scene("cornell"), "cornell");
  std::filesystem::remove("cornell");
  std::filesystem::create_directory("cornell");
  EXPECT_THAT(find_scene("cornell"), EndsWith("/scenes/cornell/scene.json"));
  std::filesystem::current_path(before);
}

TEST(ExampleScenes, AreSuggestedForSimilarNames) {
  EXPECT_EQ(suggest_example("corell"), "there is no scene 'corell'; did you mean 'cornell'?");
  EXPECT_EQ(suggest_example("cook_torance_sampling/uniform"),
            "there is no scene 'cook_torance_sampling/uniform'; did you mean "
            "'cook_torrance_sampling/uniform'?");
  EXPECT_EQ(suggest_example("cook_torrance_sampling"),
            "there is no scene 'cook_torrance_sampling'; known are 'cook_torrance_sampling/half_vector', "
            "'cook_torrance_sampling/uniform', 'cook_torrance_sampling/visible_normals'");
  for (const char* name : {"cornell", "", "none", "none.json", "/corell"})
    EXPECT_EQ(suggest_example(name), "");
}

}  // namespace
}  // namespace tessera::client
