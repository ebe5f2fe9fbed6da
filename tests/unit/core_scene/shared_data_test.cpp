// SPDX-License-Identifier: Apache-2.0
// Meshes that nobody here made, where they are at hand.
#include <gtest/gtest.h>

#include <filesystem>

#include "core/scene/loader/loader.hpp"
#include "core/scene/loader/obj_reader.hpp"
#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core::shared_data_test {
namespace {

constexpr const char* kSharedFolder = TESSERA_SOURCE_DIR "/../shared/data/";

// Reads scenes from memory and everything else from the folder.
class SceneOverFolder : public AssetSource {
 public:
  explicit SceneOverFolder(std::string scene) : scene_(std::move(scene)), folder_(kSharedFolder) {}
  Result<std::string> read(const std::string& path) override {
    if (path == "scene.json") return scene_;
    return folder_.read(path);
  }

 private:
  std::string scene_;
  FolderAssets folder_;
};

class SharedData : public testing::TestWithParam<std::pair<std::string, std::size_t>> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kSharedFolder)) GTEST_SKIP() << kSharedFolder << " is not there";
  }
};

TEST_P(SharedData, LoadsWithUnitNormals) {
  const auto& [file, triangles] = GetParam();
  SceneOverFolder assets(
      test::scene_with("", "", "{\"type\": \"mesh\", \"file\": \"" + file + "\", \"material\": \"light\"}"));
  const auto scene = load_scene(assets, "scene.json", "scene.json");
  ASSERT_TRUE(scene.has_value()) << scene.error().message;
  const auto& mesh = std::get<MeshDescription>(scene->shapes[0]);
  EXPECT_EQ(mesh.triangles.size(), triangles);
  EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
  for (const Vec3 n : mesh.normals) ASSERT_NEAR(length(n), 1, 1e-6f);
}

INSTANTIATE_TEST_SUITE_P(Meshes, SharedData,
                         testing::Values(std::pair("bunny.obj", 69451), std::pair("teapot.obj", 6320),
                                         std::pair("spot/spot.obj", 5856)),
                         [](const auto& name) {
                           return name.param.first.substr(name.param.first.find('/') + 1, 4);
                         });

TEST_F(SharedData, SpotWearsItsTexture) {
  SceneOverFolder assets(
      test::scene_with("\"textures\": {\"spots\": {\"file\": \"spot/spot_texture.png\"}}",
                       "\"cow\": {\"type\": \"lambert\", \"albedo\": {\"texture\": \"spots\"}}",
                       "{\"type\": \"mesh\", \"file\": \"spot/spot.obj\", \"material\": \"cow\"}"));
  const auto scene = load_scene(assets, "scene.json", "scene.json");
  ASSERT_TRUE(scene.has_value()) << scene.error().message;
  EXPECT_EQ(scene->textures[0].image->width(), 1024);
  const auto& mesh = std::get<MeshDescription>(scene->shapes[0]);
  EXPECT_EQ(mesh.uvs.size(), mesh.positions.size());
}

TEST_F(SharedData, ACutBunnyIsRefused) {
  const auto bytes = FolderAssets(kSharedFolder).read("bunny.obj");
  ASSERT_TRUE(bytes.has_value());
  EXPECT_EQ(read_obj(bytes->substr(0, 500'000), "bunny.obj").error().message.substr(0, 10), "bunny.obj:");
  const std::size_t first_face = bytes->find("\nf ") + 1;
  const auto no_faces = read_obj(bytes->substr(0, first_face), "bunny.obj");
  ASSERT_FALSE(no_faces.has_value());
  EXPECT_TRUE(
      no_faces.error().message.ends_with("the file has no faces (no 'f' statement); is it complete?"));
}

}  // namespace
}  // namespace tessera::core::shared_data_test
