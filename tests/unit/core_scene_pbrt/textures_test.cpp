// SPDX-License-Identifier: Apache-2.0
// Textures of pbrt files: constants, images, and what is evaluated into images.
#include <gmock/gmock.h>
#include <stb_image_write.h>

#include "core/image/srgb.hpp"
#include "tests/unit/core_scene_pbrt/pbrt_scene.hpp"

namespace tessera::core::test {
namespace {

using testing::HasSubstr;

// A diffuse surface whose reflectance is the texture "t", evaluated at texture coordinates.
class Reflectance {
 public:
  explicit Reflectance(const std::string& textures, const MemoryAssets::Files& files = {})
      : scene_(pbrt_world(textures + "\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\n" + kPbrtTriangle,
                          files)) {}

  const ColorParameter& parameter() const { return std::get<Lambert>(scene_.materials.at(0).model).albedo; }
  Rgb at(float u, float v) const { return parameter().evaluate(scene_.textures, Vec2{u, v}); }
  const SceneDescription& scene() const { return scene_; }

 private:
  SceneDescription scene_;
};

// Four texels: black and red above, green and blue below.
MemoryAssets::Files four_colors() {
  Image image(2, 2);
  image.pixels = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  return {{"four.png", png(image)}};
}

TEST(PbrtTextures, ChannelsOfOpenExrFilesHaveNames) {
  const auto color = [](const std::string& channel) {
    return Reflectance(
               "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.exr\" \"string "
               "channel\" \"" +
                   channel + "\"",
               {{"a.exr", layered_exr()}})
        .at(0.5f, 0.5f);
  };
  EXPECT_EQ(color("Tint"), (Rgb{0.625f, 0.75f, 0.875f}));
  EXPECT_EQ(color("Depth.Z"), Rgb::gray(0.5f));
  EXPECT_EQ(color("g"), Rgb::gray(0.25f));
}

TEST(PbrtTextures, TheFilterPointIsTheNearestTexel) {
  const Reflectance surface(
      "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"four.png\" \"string filter\" "
      "\"point\"",
      four_colors());
  expect_color(surface.at(0.49f, 0.51f), {0, 0, 0}, 1e-5f);
  expect_color(surface.at(0.51f, 0.51f), {1, 0, 0}, 1e-5f);
  expect_color(surface.at(0.49f, 0.49f), {0, 1, 0}, 1e-5f);
}

TEST(PbrtTextures, ConstantsNeedNoImage) {
  const Reflectance surface("Texture \"t\" \"spectrum\" \"constant\" \"rgb value\" [0.1 0.2 0.3]");
  EXPECT_LT(surface.parameter().texture, 0);
  EXPECT_EQ(surface.parameter().value, (Rgb{0.1f, 0.2f, 0.3f}));
  const Reflectance mixed(
      "Texture \"t\" \"spectrum\" \"mix\" \"rgb tex1\" [0 0 0] \"rgb tex2\" [1 1 1] \"float amount\" 0.25");
  EXPECT_EQ(mixed.parameter().value, Rgb::gray(0.25f));
  const Reflectance scaled(
      "Texture \"a\" \"spectrum\" \"constant\" \"rgb value\" [1 0.5 0]\n"
      "Texture \"t\" \"spectrum\" \"scale\" \"texture tex\" \"a\" \"float scale\" 0.5");
  EXPECT_EQ(scaled.parameter().value, (Rgb{0.5f, 0.25f, 0}));
}

TEST(PbrtTextures, ImagesStayImages) {
  const Reflectance surface(
      "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"four.png\" \"float scale\" 0.5 "
      "\"float uscale\" 2 \"float vdelta\" 0.5 \"string filter\" \"trilinear\"",
      four_colors());
  EXPECT_EQ(surface.scene().textures.size(), 1u);
  EXPECT_EQ(surface.scene().textures[0].image->width(), 2);
  // (s, t) is (0.25, 0.25), the lower left texel.
  expect_color(surface.at(0.125f, -0.25f), {0, 0.5f, 0});
  EXPECT_EQ(warnings_of(surface.scene()), "");
}

// Also the outer texels are blended with black.
TEST(PbrtTextures, ImagesThatAreBlackOutside) {
  const auto color_at = [](const std::string& parameters, float u, float v) {
    const Reflectance surface(
        "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"four.png\" "
        "\"string wrap\" \"black\" \"float uscale\" 2 " +
            parameters,
        four_colors());
    EXPECT_EQ(warnings_of(surface.scene()), "");
    return surface.at(u, v);
  };
  expect_color(color_at("", 0.125f, 0.25f), {0, 1, 0});
  expect_color(color_at("", 0, 0.25f), {0, 0.5f, 0});
  expect_color(color_at("\"string filter\" \"point\"", 0.01f, 0.25f), {0, 1, 0});
  expect_color(color_at("\"float scale\" 0.5", 0.125f, 0.25f), {0, 0.5f, 0});
  expect_color(color_at("\"bool invert\" true", 0.125f, 0.25f), {1, 0, 1});
  for (const Vec2 outside : {Vec2{-0.2f, 0.25f}, Vec2{0.7f, 0.25f}, Vec2{5, 5}, Vec2{0.125f, -0.3f}}) {
    expect_color(color_at("", outside.x, outside.y), {});
    expect_color(color_at("\"string filter\" \"point\"", outside.x, outside.y), {});
    expect_color(color_at("\"bool invert\" true", outside.x, outside.y), {1, 1, 1});
  }
}

TEST(PbrtTextures, AlphaIsTransparentOutsideOfABlackWrap) {
  const SceneDescription scene = pbrt_world(
      "Texture \"a\" \"float\" \"imagemap\" \"string filename\" \"white.png\" \"string wrap\" "
      "\"black\"\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"texture alpha\" \"a\"",
      {{"white.png", png(one_color(2, 2, Rgb::gray(1)))}});
  const ScalarParameter& opacity = scene.materials.at(0).opacity;
  EXPECT_NEAR(opacity.evaluate(scene.textures, Vec2{0.5f, 0.5f}), 1, 1e-5f);
  EXPECT_NEAR(opacity.evaluate(scene.textures, Vec2{1.5f, 0.5f}), 0, 1e-5f);
}

TEST(PbrtTextures, InvertedImages) {
  const Reflectance surface(
      "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"four.png\" \"bool invert\" true",
      four_colors());
  expect_color(surface.at(0.25f, 0.25f), {1, 0, 1});
  expect_color(surface.at(0.75f, 0.75f), {0, 1, 1});
}

TEST(PbrtTextures, EncodingsOfPng) {
  const MemoryAssets::Files files{{"gray.png", png(one_color(1, 1, Rgb::gray(0.5f)))}};
  const auto gray = [&](const std::string& encoding) {
    return Reflectance("Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"gray.png\"" + encoding,
                       files)
        .at(0.5f, 0.5f)
        .g;
  };
  const float linear = gray(" \"string encoding\" \"linear\"");
  EXPECT_GT(linear, gray("") + 0.1f);
  EXPECT_NEAR(gray(" \"string encoding\" \"gamma 2\""), linear * linear, 1e-3);
}

// A PNG file of two pixels with the alpha 128 and 255 of 255.
std::string half_transparent() {
  const std::vector<std::uint8_t> pixels{255, 255, 255, 128, 255, 255, 255, 255};
  std::string file;
  stbi_write_png_to_func(
      [](void* context, void* data, int size) {
        static_cast<std::string*>(context)->append(static_cast<const char*>(data),
                                                   static_cast<std::size_t>(size));
      },
      &file, 2, 1, 4, pixels.data(), 8);
  return file;
}

TEST(PbrtTextures, AlphaIsEncodedAsColours) {
  const auto opacity = [](const std::string& encoding) {
    const SceneDescription scene =
        pbrt_world("Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"a.png\"" + encoding +
                       "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"texture alpha\" \"t\"",
                   {{"a.png", half_transparent()}});
    return scene.materials.at(0).opacity.evaluate(scene.textures, Vec2{0.25f, 0.5f});
  };
  EXPECT_NEAR(opacity(""), srgb_decode(std::uint8_t{128}), 1e-4f);
  EXPECT_NEAR(opacity("\"string encoding\" \"linear\""), 128 / 255.0f, 1e-4f);
  EXPECT_NEAR(opacity("\"string encoding\" \"gamma 2\""), 128 * 128 / (255.0f * 255), 1e-4f);
}

TEST(PbrtTextures, CheckerboardsAreEvaluated) {
  const Reflectance surface(
      "Texture \"t\" \"spectrum\" \"checkerboard\" \"float uscale\" 4 \"float vscale\" 2 "
      "\"rgb tex1\" [1 0 0] \"rgb tex2\" [0 0 1]");
  for (int i = -3; i < 9; ++i)
    for (int j = -2; j < 5; ++j) {
      const bool is_first = ((i + j) & 1) == 0;
      expect_color(surface.at((static_cast<float>(i) + 0.5f) / 4, (static_cast<float>(j) + 0.5f) / 2),
                   is_first ? Rgb{1, 0, 0} : Rgb{0, 0, 1});
    }
}

TEST(PbrtTextures, ImagesInCheckerboards) {
  const Reflectance surface(
      "Texture \"i\" \"spectrum\" \"imagemap\" \"string filename\" \"four.png\" \"float uscale\" 2\n"
      "Texture \"t\" \"spectrum\" \"checkerboard\" \"float uscale\" 4 \"float vscale\" 1 \"texture tex1\" "
      "\"i\" "
      "\"rgb tex2\" [1 1 1]",
      four_colors());
  expect_color(surface.at(0.125f, 0.25f), {0, 1, 0}, 0.03f);  // the first square: the left half of the image
  expect_color(surface.at(0.375f, 0.25f), {1, 1, 1}, 0.03f);
  EXPECT_EQ(warnings_of(surface.scene()), "");
}

TEST(PbrtTextures, NumbersOfColouredImagesAreMeans) {
  const SceneDescription scene = pbrt_world(
      "Texture \"r\" \"float\" \"imagemap\" \"string filename\" \"four.png\"\n"
      "Material \"dielectric\" \"texture roughness\" \"r\" \"bool remaproughness\" false\n" +
          kPbrtTriangle,
      four_colors());
  const ScalarParameter& roughness = std::get<Glass>(scene.materials.at(0).model).roughness;
  EXPECT_NEAR(roughness.evaluate(scene.textures, Vec2{0.25f, 0.75f}), 0, 1e-3);
  EXPECT_NEAR(roughness.evaluate(scene.textures, Vec2{0.25f, 0.25f}), 0.57735, 1e-3);
}

TEST(PbrtTextures, TexturedTrianglesGetTextureCoordinates) {
  const Reflectance surface("Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"four.png\"",
                            four_colors());
  const auto& mesh = std::get<MeshDescription>(surface.scene().shapes.at(0));
  EXPECT_EQ(mesh.uvs, (std::vector<Vec2>{{0, 0}, {1, 0}, {1, 1}}));
}

TEST(PbrtTextures, WhatIsMissingIsGray) {
  const Reflectance surface("Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"gone.png\"");
  EXPECT_EQ(surface.parameter().value, Rgb::gray(0.5f));
  EXPECT_THAT(warnings_of(surface.scene()), HasSubstr("scene.pbrt:2: the image 'gone.png' does not exist"));
  EXPECT_THAT(warnings_of(Reflectance("").scene()), HasSubstr("scene.pbrt:3: there is no texture 't'"));
  EXPECT_THAT(warnings_of(Reflectance("Texture \"t\" \"spectrum\" \"ptex\"").scene()),
              HasSubstr("the texture 'ptex' is not supported; gray is used"));
}

const ProceduralTexture& pattern_of(const Reflectance& surface) {
  return surface.scene()
      .textures.at(static_cast<std::size_t>(surface.parameter().texture))
      .procedural.value();
}

TEST(PbrtTextures, PatternsInSpaceLieWhereTheyAreDefined) {
  const Reflectance surface(
      "Translate 1 0 0 Scale 2 2 2\n"
      "Texture \"t\" \"spectrum\" \"marble\" \"integer octaves\" 3 \"float roughness\" 0.25 "
      "\"float scale\" 4 \"float variation\" 0.5 Identity");
  EXPECT_EQ(warnings_of(surface.scene()), "");
  const ProceduralTexture& marble = pattern_of(surface);
  EXPECT_EQ(marble.pattern, Pattern(MarblePattern{3, 0.25f, 4, 0.5f}));
  EXPECT_EQ(marble.space, PatternSpace::kPosition);
  EXPECT_EQ(marble.transform.point({3, 0, 0}), (Vec3{1, 0, 0}));
  EXPECT_EQ(marble.max, 1);
}

TEST(PbrtTextures, PatternsMayHaveTexturesAndBePartsOfOthers) {
  const Reflectance surface(
      "Texture \"i\" \"spectrum\" \"imagemap\" \"string filename\" \"four.png\"\n"
      "Texture \"f\" \"float\" \"fbm\"\n"
      "Texture \"d\" \"spectrum\" \"dots\" \"texture inside\" \"i\" \"rgb outside\" [0 0 1] \"float uscale\" "
      "4\n"
      "Texture \"t\" \"spectrum\" \"mix\" \"texture tex1\" \"d\" \"rgb tex2\" [1 0 0] \"texture amount\" "
      "\"f\"",
      four_colors());
  EXPECT_EQ(warnings_of(surface.scene()), "");
  const auto& mix = std::get<MixPattern>(pattern_of(surface).pattern);
  const auto& textures = surface.scene().textures;
  const auto& dots = textures.at(static_cast<std::size_t>(mix.first.texture)).procedural.value();
  EXPECT_EQ(mix.second, (ColorParameter{{1, 0, 0}, -1}));
  EXPECT_EQ(textures.at(static_cast<std::size_t>(mix.amount.texture)).procedural->pattern,
            Pattern(FbmPattern()));
  EXPECT_EQ(dots.space, PatternSpace::kUv);
  EXPECT_EQ(dots.transform.point({0.5f, 0.5f, 0}), (Vec3{2, 0.5f, 0}));
  EXPECT_EQ(std::get<DotsPattern>(dots.pattern).outside.value, (Rgb{0, 0, 1}));
  const int image = std::get<DotsPattern>(dots.pattern).inside.texture;
  EXPECT_NE(textures.at(static_cast<std::size_t>(image)).image, nullptr);
}

// The first where the surface faces the direction, which is one of the space of the texture.
TEST(PbrtTextures, DirectionsOfSurfacesMixTextures) {
  const Reflectance surface(
      "Rotate 90 0 0 1\n"
      "Texture \"t\" \"spectrum\" \"directionmix\" \"rgb tex1\" [1 0 0] \"rgb tex2\" [0 0 1] "
      "\"vector3 dir\" [0 -2 0] Identity");
  EXPECT_EQ(warnings_of(surface.scene()), "");
  const auto& textures = surface.scene().textures;
  const Texture& mix = textures.at(static_cast<std::size_t>(surface.parameter().texture));
  const auto facing = [&](Vec3 normal) { return mix.evaluate_procedural(textures, {UvSets(), {}, normal}); };
  EXPECT_NEAR(facing({1, 0, 0}).r, 1, 1e-6f);
  EXPECT_NEAR(facing({-1, 0, 0}).b, 0, 1e-6f);
  EXPECT_NEAR(facing({0, 0.8f, 0.6f}).b, 1, 1e-6f);
  EXPECT_NEAR(facing({0.6f, 0.8f, 0}).r, 0.6f, 1e-6f);
  EXPECT_THAT(
      warnings_of(Reflectance("Texture \"t\" \"spectrum\" \"directionmix\" \"vector3 dir\" [0 0 0]").scene()),
      HasSubstr("has no length; the z axis is used"));
}

TEST(PbrtTextures, MappingsMayLieInSpace) {
  const auto projection = [](const std::string& mapping) {
    const Reflectance surface(
        "Translate 0 1 0 Texture \"t\" \"spectrum\" \"checkerboard\" \"string mapping\" " + mapping +
        " Identity");
    EXPECT_EQ(warnings_of(surface.scene()), "");
    const ProceduralTexture& made = pattern_of(surface);
    EXPECT_EQ(made.space, PatternSpace::kPosition);
    return std::pair(std::get<ProjectedPattern>(made.pattern).projection, made.transform);
  };
  EXPECT_EQ(projection("\"spherical\""), std::pair(Projection::kSpherical, translation({0, -1, 0})));
  EXPECT_EQ(projection("\"cylindrical\""), std::pair(Projection::kCylindrical, translation({0, -1, 0})));
  const auto [kind, plane] =
      projection("\"planar\" \"vector3 v1\" [2 0 0] \"vector3 v2\" [0 0 -4] \"float udelta\" 0.5");
  EXPECT_EQ(kind, Projection::kPlanar);
  EXPECT_EQ(plane.point({3, 7, 1}).x, 6.5f);
  EXPECT_EQ(plane.point({3, 7, 1}).y, -4);
  EXPECT_THAT(warnings_of(Reflectance("Texture \"t\" \"spectrum\" \"checkerboard\" \"string mapping\" "
                                      "\"planar\" \"vector3 v1\" [0 0 0]")
                              .scene()),
              HasSubstr("a planar mapping without a plane"));
  EXPECT_THAT(
      warnings_of(
          Reflectance("Texture \"t\" \"spectrum\" \"checkerboard\" \"string mapping\" \"polar\"").scene()),
      HasSubstr("'polar', which is not known; 'uv' is used"));
}

// Checkerboards of texture coordinates alone stay images.
TEST(PbrtTextures, CheckerboardsOfPatternsAreComputedWhereTheyAreHit) {
  const Reflectance surface(
      "Texture \"m\" \"spectrum\" \"marble\"\n"
      "Texture \"t\" \"spectrum\" \"checkerboard\" \"texture tex1\" \"m\" \"float uscale\" 2 \"float "
      "vscale\" 0");
  EXPECT_TRUE(std::holds_alternative<CheckerboardPattern>(pattern_of(surface).pattern));
  EXPECT_NE(pattern_of(surface).transform.determinant(), 0);
  const Reflectance plain("Texture \"t\" \"spectrum\" \"checkerboard\"");
  EXPECT_NE(plain.scene().textures.at(0).image, nullptr);
}

TEST(PbrtTextures, TexturesThatGrowWithoutEndAreRefused) {
  std::string textures =
      "WorldBegin Texture \"t0\" \"spectrum\" \"imagemap\" \"string filename\" \"four.png\"\n";
  for (int i = 1; i < 40; ++i) {
    const std::string before = std::to_string(i - 1), own = std::to_string(i);
    textures += "Texture \"t" + own + "\" \"spectrum\" \"mix\" \"texture tex1\" \"t" + before +
                "\" \"texture tex2\" \"t" + before + "\"\n";
  }
  EXPECT_THAT(pbrt_error(textures, four_colors()), HasSubstr("refers to too many others"));
}

}  // namespace
}  // namespace tessera::core::test
