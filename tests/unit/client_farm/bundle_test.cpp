#include "client/farm/bundle.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "core/scene/loader/loader.hpp"
#include "proto/blob.hpp"

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
  const auto local = bundle_scene(kFolder + "/scene.json", overrides);
  ASSERT_TRUE(local.has_value()) << local.error().message;
  EXPECT_EQ(local->bundle.scene_path(), "scene.json");
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
  const std::string path = kFolder + "/box.obj";
  const auto local = bundle_scene(path, {});
  const auto here = core::load_scene_file(path);
  ASSERT_FALSE(local.has_value());
  ASSERT_FALSE(here.has_value());
  EXPECT_EQ(local.error().message, here.error().message);
}

TEST(Bundle, ChecksOverrides) {
  core::RenderOverrides overrides;
  overrides.width_px = 0;
  const auto local = bundle_scene(kFolder + "/scene.json", overrides);
  ASSERT_FALSE(local.has_value());
  EXPECT_EQ(local.error().code, core::ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace tessera::client
