// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <tessera/tessera.hpp>
#include <vector>

#include "tests/support/temporary_folder.hpp"

namespace tessera {
namespace {

using testing::HasSubstr;

const std::string kCornell = TESSERA_SOURCE_DIR "/scenes/cornell/scene.json";

RenderOptions small() {
  RenderOptions options;
  options.width = 80;  // more than one tile
  options.height = 72;
  options.spp = 4;
  return options;
}

template <typename Function>
std::string error_of(const Function& function) {
  try {
    function();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Library, RendersTheSameByAnyNumberOfThreads) {
  const Scene scene = Scene::load(kCornell);
  RenderOptions options = small();
  options.threads = 1;
  const Image one = scene.render(options);
  EXPECT_EQ(one.width, 80);
  EXPECT_EQ(one.height, 72);
  ASSERT_EQ(one.rgb.size(), 80u * 72 * 3);
  EXPECT_THAT(one.rgb, testing::Contains(testing::Gt(0.1f)));
  options.threads = 3;
  EXPECT_EQ(scene.render(options).rgb, one.rgb);
  options.seed = 1;
  EXPECT_NE(scene.render(options).rgb, one.rgb);
}

TEST(Library, SaysHowFarItIsAndStopsWhenAsked) {
  const Scene scene = Scene::load(kCornell);
  RenderOptions options = small();
  std::vector<double> shares;
  options.progress = [&](double share) {
    shares.push_back(share);
    return true;
  };
  const Image complete = scene.render(options);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_GT(shares.front(), 0);
  EXPECT_EQ(shares.back(), 1);

  int calls = 0;
  options.progress = [&](double) { return ++calls < 2; };
  EXPECT_NE(scene.render(options).rgb, complete.rgb);
  EXPECT_EQ(calls, 2);
}

TEST(Library, SaysWhatIsWrong) {
  EXPECT_THAT(error_of([] { Scene::load("none.json"); }), HasSubstr("'none.json' does not exist"));
  const Scene scene = Scene::load(kCornell);
  RenderOptions options = small();
  options.width = 0;
  EXPECT_THAT(error_of([&] { scene.render(options); }), HasSubstr("width"));
  options = small();
  options.threads = -1;
  EXPECT_EQ(error_of([&] { scene.render(options); }), "threads must not be negative");
}

TEST(Library, WritesImagesByTheEndingOfTheirNames) {
  const TemporaryFolder folder;
  Image image;
  image.width = 2;
  image.height = 1;
  image.rgb = {0, 0.5f, 1, 2, 0, 0};
  for (const char* ending : {"png", "exr", "hdr", "pfm"}) {
    const std::string path = (folder.path() / "image.").string() + ending;
    EXPECT_EQ(error_of([&] { write_image(image, path); }), "no error") << path;
    EXPECT_GT(std::filesystem::file_size(path), 20u) << path;
  }
  EXPECT_THAT(error_of([&] { write_image(image, "image.doc"); }), HasSubstr("image.doc"));
  image.rgb.pop_back();
  EXPECT_EQ(error_of([&] { write_image(image, (folder.path() / "short.png").string()); }),
            "an image must have height * width * 3 values");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "short.png"));
}

}  // namespace
}  // namespace tessera
