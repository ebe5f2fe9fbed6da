// SPDX-License-Identifier: Apache-2.0
#include "client/farm/bundle.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "core/scene/loader/asset_source.hpp"
#include "core/scene/loader/loader.hpp"
#include "proto/blob.hpp"
#include "proto/text.hpp"
#include "tests/support/bundle_files.hpp"
#include "tests/support/temporary_folder.hpp"

namespace tessera::client {
namespace {

const std::string kFolder = TESSERA_SOURCE_DIR "/scenes/cornell";

std::string read_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(Bundle, HoldsTheSceneAndEveryFileItReads) {
  core::RenderOverrides overrides;
  overrides.spp = 5;
  const auto local = bundle_scene(kFolder + "/scene.json", {.overrides = overrides});
  ASSERT_TRUE(local.has_value()) << local.error().message;
  EXPECT_EQ(local->bundle.scene_path(), "scene.json");
  EXPECT_EQ(local->name, "cornell");
  std::vector<std::string> paths;
  for (const v1::Bundle::Asset& asset : local->bundle.assets()) {
    paths.push_back(asset.path());
    EXPECT_EQ(proto::from_proto(asset.digest()).value(),
              proto::digest_of(read_file(kFolder + "/" + asset.path())));
  }
  EXPECT_EQ(paths, (std::vector<std::string>{"box.mtl", "box.obj", "scene.json"}));
  EXPECT_EQ(local->settings.spp, 5u);
}

TEST(Bundle, RefusesInTheWordsOfALocalRender) {
  const TemporaryFolder folder;
  const std::string path = folder.path() / "broken.json";
  std::ofstream(path) << "{ \"camera\": 1 }\n";
  const auto local = bundle_scene(path, {});
  const auto here = core::load_scene_file(path);
  ASSERT_FALSE(local.has_value());
  ASSERT_FALSE(here.has_value());
  EXPECT_EQ(local.error().message, here.error().message);
}

TEST(Bundle, KnowsItsWarningsInTheWordsOfACoordinator) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "scene.pbrt") << R"(Film "rgb" "string filename" "x.png"
WorldBegin
Include "part.pbrt"
Shape "sphere" "float zmin" 0 "float lost" 1
)";
  std::ofstream(folder.path() / "part.pbrt") << "Material \"diffuse\" \"float missing\" 1\n";
  const auto local = bundle_scene(folder.path() / "scene.pbrt", {});
  ASSERT_TRUE(local.has_value()) << local.error().message;
  core::FolderAssets files(folder.path().string());
  const auto there = core::load_scene(files, "scene.pbrt", "scene.pbrt");
  ASSERT_TRUE(there.has_value()) << there.error().message;
  ASSERT_GE(there->warnings.size(), 2u);
  for (const std::string& warning : there->warnings) EXPECT_TRUE(has_warning(*local, warning)) << warning;
  EXPECT_FALSE(has_warning(*local, "something else"));
}

constexpr const char* kLatin1Texture = "caf\xe9.png";

// Writes a scene whose mesh has a texture with a name in Latin-1. `more` are its further keys.
void write_latin1_scene(const std::filesystem::path& folder, const std::string& scene,
                        const std::string& more) {
  const auto write = [&](const std::string& name, const std::string& text) {
    std::ofstream(folder / name, std::ios::binary) << text;
  };
  write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
  write("a.mtl", std::string("newmtl m\nmap_Kd ") + kLatin1Texture + "\n");
  write(kLatin1Texture, read_file(TESSERA_SOURCE_DIR "/tests/unit/client_farm/pixel.png"));
  write(scene,
        R"({"camera": {"position": [0, 0, 5], "look_at": [0, 0, 0]}, "environment": {"radiance": 1}, )" +
            more + R"("shapes": [{"type": "mesh", "file": "a.obj"}]})");
}

// File names are sent as UTF-8, and a reader of the bundle finds each file by its original name.
TEST(Bundle, CarriesNamesThatAreNotUtf8) {
  const TemporaryFolder folder;
  const std::string scene = folder.path() / "sc\xe8ne.json";
  write_latin1_scene(folder.path(), "sc\xe8ne.json", "");
  ASSERT_TRUE(core::load_scene_file(scene)) << "it renders here";

  const auto local = bundle_scene(scene, {});
  ASSERT_TRUE(local) << local.error().message;
  EXPECT_EQ(local->bundle.scene_path(), "sc\\xe8ne.json");
  std::map<std::string, std::string> blobs;
  for (const v1::Bundle::Asset& asset : local->bundle.assets()) {
    EXPECT_TRUE(proto::check_text("path", asset.path())) << asset.path();
    blobs[asset.path()] = folder.path() / local->paths.at(asset.path());
  }
  EXPECT_TRUE(blobs.contains("caf\\xe9.png"));
  core::BundleAssets assets = bundle_at(blobs);
  const auto there = core::load_scene(assets, local->bundle.scene_path(), local->bundle.scene_path());
  ASSERT_TRUE(there) << there.error().message;
  EXPECT_EQ(there->textures.size(), 1u);
}

TEST(Bundle, RefusesTwoFilesOfOneName) {
  const TemporaryFolder folder;
  write_latin1_scene(folder.path(), "scene.json", R"("textures": {"t": {"file": "caf\\xe9.png"}}, )");
  std::filesystem::copy(folder.path() / kLatin1Texture, folder.path() / "caf\\xe9.png");
  ASSERT_TRUE(core::load_scene_file(folder.path() / "scene.json"));
  const auto local = bundle_scene(folder.path() / "scene.json", {});
  ASSERT_FALSE(local);
  EXPECT_NE(local.error().message.find("rename one of them"), std::string::npos) << local.error().message;
}

// A choice is a part of the scene file that is sent.
TEST(Bundle, CarriesTheChoiceOfACamera) {
  const TemporaryFolder folder;
  const std::string scene = folder.path() / "scene.xml", sent = folder.path() / "sent.xml";
  std::ofstream(scene) << "<scene version='3.0.0'><shape type='sphere'/><sensor type='perspective'/>"
                          "<sensor type='perspective' id='right'><transform name='to_world'>"
                          "<translate x='3'/></transform></sensor></scene>";
  const auto local = bundle_scene(scene, {.parameters = {core::select_by_name("camera", "right")}});
  ASSERT_TRUE(local) << local.error().message;
  ASSERT_TRUE(local->scene_text);
  EXPECT_EQ(proto::from_proto(local->bundle.assets(0).digest()).value(),
            proto::digest_of(*local->scene_text));
  std::ofstream(sent) << *local->scene_text;
  core::BundleAssets assets = bundle_at({{"scene.xml", sent}});
  const auto there = core::load_scene(assets, "scene.xml", "scene.xml");
  ASSERT_TRUE(there) << there.error().message;
  EXPECT_EQ(there->camera.position.x, 3);
}

TEST(Bundle, ChecksOverrides) {
  core::RenderOverrides overrides;
  overrides.width_px = 0;
  const auto local = bundle_scene(kFolder + "/scene.json", {.overrides = overrides});
  ASSERT_FALSE(local.has_value());
  EXPECT_EQ(local.error().code, core::ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace tessera::client
