// SPDX-License-Identifier: Apache-2.0
// Scenes of unknown origin: how much they may hold, and that an image is refused before it is unpacked.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stb_image_write.h>

#include "core/scene/loader/loader.hpp"
#include "core/textures/image_decoder.hpp"
#include "tests/support/hostile_images.hpp"
#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core {
namespace {

using test::one_color;
using testing::HasSubstr;

constexpr const char* kTwoTriangles = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

std::string mesh(const std::string& file) {
  return fmt::format(R"({{"type": "mesh", "file": "{}", "material": "light"}})", file);
}

std::string textures(const std::vector<std::string>& files) {
  std::string entries;
  for (std::size_t i = 0; i < files.size(); ++i)
    entries += fmt::format("{}\"t{}\": {{\"file\": \"{}\"}}", i == 0 ? "" : ", ", i, files[i]);
  return "\"textures\": {" + entries + "}";
}

std::string jpeg(int width, int height) {
  std::string bytes;
  const std::string pixels(static_cast<std::size_t>(3 * width * height), '\x7f');
  stbi_write_jpg_to_func(
      [](void* to, void* data, int size) {
        static_cast<std::string*>(to)->append(static_cast<char*>(data), static_cast<std::size_t>(size));
      },
      &bytes, width, height, 3, pixels.data(), 90);
  return bytes;
}

class SceneLimitsTest : public testing::Test {
 protected:
  SceneLimitsTest() {
    limits_.triangles.option = "--triangles";
    limits_.lights.option = "--lights";
    limits_.texture_pixels.option = "--pixels";
    limits_.scene_texture_pixels.option = "--all-pixels";
  }

  Result<SceneDescription> load(const std::string& scene) {
    test::MemoryAssets::Files files = files_;
    files["scene.json"] = scene;
    test::MemoryAssets assets(std::move(files));
    return load_scene(assets, "scene.json", "scene.json", limits_);
  }
  std::string load_shapes(const std::string& shapes) {
    return message_of(load(test::scene_with("", "", shapes)));
  }
  std::string load_textures(const std::vector<std::string>& files) {
    return message_of(load(test::scene_with(textures(files), "", "")));
  }
  // Empty where all is well.
  static std::string message_of(const Result<SceneDescription>& scene) {
    if (scene) return "";
    EXPECT_EQ(scene.error().code, ErrorCode::kResourceExhausted) << scene.error().message;
    return scene.error().message;
  }

  test::MemoryAssets::Files files_{{"two.obj", kTwoTriangles}};
  SceneLimits limits_;
};

TEST_F(SceneLimitsTest, OnOnesOwnMachineThereAreNone) {
  files_["wood.png"] = test::png(one_color(64, 64, {}));
  EXPECT_EQ(load_shapes(mesh("two.obj")), "");
  EXPECT_EQ(load_textures({"wood.png"}), "");
}

TEST_F(SceneLimitsTest, TrianglesOfOneFile) {
  limits_.triangles.most = 2;
  EXPECT_EQ(load_shapes(mesh("two.obj")), "");
  limits_.triangles.most = 1;
  EXPECT_THAT(
      load_shapes(mesh("two.obj")),
      HasSubstr(
          "two.obj:5: the file has more than the 1 triangles that a scene may have here (--triangles)"));
}

TEST_F(SceneLimitsTest, FacesAreCountedBeforeTheyAreRead) {
  limits_.triangles.most = 1;
  files_["two.obj"] = "v 0 0 0\nf 7 7 7\nf 8 8 8\n";  // refer to nothing
  EXPECT_THAT(load_shapes(mesh("two.obj")),
              HasSubstr("two.obj: the file has 2 faces, more than the 1 triangles"));
}

TEST_F(SceneLimitsTest, AFileCountsAsOftenAsItsTrianglesAreStored) {
  limits_.triangles.most = 4;
  EXPECT_EQ(load_shapes(mesh("two.obj") + "," + mesh("two.obj")), "");
  limits_.triangles.most = 5;
  EXPECT_THAT(load_shapes(mesh("two.obj") + "," + mesh("two.obj") + "," + mesh("two.obj")),
              HasSubstr("with 'two.obj' the scene has 6 triangles, more than the 5"));
}

std::string emissive_object(const std::string& shapes) {
  return fmt::format("\"objects\": {{\"lamp\": {{\"shapes\": [{}]}}}}", shapes);
}

TEST_F(SceneLimitsTest, LightsOfEveryInstance) {
  const std::string instance = R"({"type": "instance", "object": "lamp"})";
  const std::string scene = test::scene_with(emissive_object(mesh("two.obj")), "",
                                             instance + "," + instance + "," + mesh("two.obj"));
  limits_.lights.most = 7;
  EXPECT_EQ(message_of(load(scene)), "");
  limits_.lights.most = 6;
  EXPECT_THAT(message_of(load(scene)),
              HasSubstr("scene.json: the scene has 7 lights (emissive triangles and other "
                        "shapes, again for every instance), more than the 6 that it may "
                        "have here (--lights)"));
}

// A material of the instance's own makes all of its object emit, or none of it.
TEST_F(SceneLimitsTest, LightsByTheMaterialOfAnInstance) {
  const std::string lit = R"({"type": "instance", "object": "lamp", "material": "light"})";
  const std::string dark = R"({"type": "instance", "object": "lamp", "material": "dark"})";
  const std::string material = R"("dark": {"type": "lambert", "albedo": [0.5, 0.5, 0.5]})";
  limits_.lights.most = 1;
  EXPECT_EQ(message_of(load(test::scene_with(emissive_object(mesh("two.obj")), material, dark + "," + dark))),
            "");
  EXPECT_THAT(
      message_of(load(test::scene_with(emissive_object(mesh("two.obj")), material, lit + "," + dark))),
      HasSubstr("has 3 lights"));
}

TEST_F(SceneLimitsTest, PixelsOfOneImageWhateverItsFormat) {
  files_["a.png"] = test::png(one_color(10, 7, {}));
  files_["b.jpg"] = jpeg(10, 7);
  files_["c.hdr"] = test::hdr(one_color(10, 7, {}));
  limits_.texture_pixels.most = 70;
  for (const char* file : {"a.png", "b.jpg", "c.hdr"}) EXPECT_EQ(load_textures({file}), "") << file;
  limits_.texture_pixels.most = 69;
  for (const char* file : {"a.png", "b.jpg", "c.hdr"})
    EXPECT_THAT(
        load_textures({file}),
        HasSubstr(fmt::format("scene.json:2: textures.t0.file: '{}' has 10 x 7 = 70 pixels, more than the "
                              "69 that a texture may have here (--pixels)",
                              file)));
}

// Files of a few bytes: there is nothing behind their headers that could be unpacked.
TEST_F(SceneLimitsTest, TheHeaderIsEnough) {
  limits_.texture_pixels.most = 1'000'000;
  files_["8.png"] = png_header(30000, 30000);
  files_["16.png"] = png_header(30000, 30000, 16);
  files_["flat.hdr"] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 30000 +X 30000\n";
  for (const char* file : {"8.png", "16.png", "flat.hdr"})
    EXPECT_THAT(load_textures({file}), HasSubstr("has 30000 x 30000 = 900000000 pixels")) << file;
}

TEST_F(SceneLimitsTest, PixelsOfAllImages) {
  files_["a.png"] = test::png(one_color(10, 7, {}));
  files_["b.png"] = test::png(one_color(10, 7, Rgb::gray(1)));
  limits_.scene_texture_pixels.most = 140;
  EXPECT_EQ(load_textures({"a.png", "b.png", "a.png"}), "") << "each counts once";
  limits_.scene_texture_pixels.most = 139;
  EXPECT_THAT(
      load_textures({"a.png", "b.png"}),
      HasSubstr("with 'b.png' the scene's textures have 140 pixels, more than the 139 that a scene's may "
                "have here (--all-pixels)"));
}

// Only the rows of the image are unpacked.
TEST(TextureBomb, OnePixelDoesNotUnpackToMegabytes) {
  for (const std::size_t runs : {1u, 400'000u}) {
    const auto image = decode_texture_image(png_bomb(runs), ColorSpace::kSrgb);
    ASSERT_TRUE(image.has_value()) << image.error().message;
    EXPECT_EQ(image->largest(), Rgb{});
  }
}

TEST(TextureBomb, ImagesOfAllShapesHaveTheMemoryTheyNeed) {
  for (const auto& [width, height] :
       {std::pair(1, 1), std::pair(1, 4000), std::pair(4000, 1), std::pair(513, 257)}) {
    const auto decoded = decode_texture_image(jpeg(width, height), ColorSpace::kSrgb);
    EXPECT_TRUE(decoded.has_value()) << width << " x " << height << ": " << decoded.error().message;
    EXPECT_TRUE(decode_texture_image(test::png(one_color(width, height, {})), ColorSpace::kSrgb).has_value());
    EXPECT_TRUE(
        decode_texture_image(test::hdr(one_color(width, height, {})), ColorSpace::kLinear).has_value());
  }
}

}  // namespace
}  // namespace tessera::core
