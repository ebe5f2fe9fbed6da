// SPDX-License-Identifier: Apache-2.0
#include "client/image_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/image/compare.hpp"
#include "core/image/decode.hpp"

namespace tessera::client {
namespace {

using testing::HasSubstr;

std::string temporary_path(const std::string& name) {
  const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
  return testing::TempDir() + test.test_suite_name() + "." + test.name() + "." + name;
}

TEST(ImageFiles, EveryPathGetsTheImage) {
  core::Image image(2, 1);
  image.at(1, 0) = {1, 0.5f, 0};
  const std::vector<std::string> paths = {temporary_path("exr"), temporary_path("pfm")};
  std::vector<std::string> named;
  for (const std::string& path : paths) named.push_back(path + "." + path.substr(path.size() - 3));
  ASSERT_TRUE(check_image_paths(named));
  ASSERT_TRUE(write_image_files(named, image, {.width_px = image.width, .height_px = image.height}, {}));
  for (const std::string& path : named) {
    EXPECT_TRUE(core::compare(core::read_image(path).value(), image).value().identical) << path;
    std::filesystem::remove(path);
  }
}

TEST(ImageFiles, BadPathsAreRefusedBeforeTheWork) {
  EXPECT_THAT(check_image_paths({"a.gif"}).error().message, HasSubstr("'a.gif'"));
  EXPECT_THAT(check_image_paths({"/no/folder/a.png"}).error().message, HasSubstr("'/no/folder'"));
  EXPECT_THAT(check_image_paths({"a.png", "b.png", "a.png"}).error().message,
              HasSubstr("'a.png' is given twice"));
  EXPECT_THAT(check_image_paths({"a.png", "./a.png"}).error().message,
              HasSubstr("'./a.png' is given twice, also as 'a.png'"));
  EXPECT_TRUE(check_image_paths({}));
}

TEST(ImageFiles, SizesAreRefusedByTheFormatThatCannotHoldThem) {
  core::RenderSettings settings{.width_px = 65536, .height_px = 16384};
  EXPECT_TRUE(check_image_size({"a.exr"}, settings));
  EXPECT_THAT(check_image_size({"a.exr", "b.hdr"}, settings).error().message, HasSubstr("b.hdr: "));
  settings.crop = core::PixelRect{0, 0, 64, 64};
  EXPECT_TRUE(check_image_size({"a.exr", "b.hdr"}, settings));
}

TEST(ImageFiles, AFailureNamesThePath) {
  EXPECT_THAT(write_image_files({"/no/folder/a.png"}, core::Image(1, 1), {.width_px = 1, .height_px = 1}, {})
                  .error()
                  .message,
              HasSubstr("/no/folder/a.png"));
}

}  // namespace
}  // namespace tessera::client
