// SPDX-License-Identifier: Apache-2.0
// Files and directives of pbrt scenes that are missing, or are found by another name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/unit/core_scene_pbrt/pbrt_scene.hpp"

namespace tessera::core::test {
namespace {

using testing::HasSubstr;

// The warnings of a world to which a triangle is added.
std::string told_of(const std::string& world, const MemoryAssets::Files& files = {}) {
  return warnings_of(pbrt_world(world + "\n" + kPbrtTriangle, files));
}

std::string image_texture(const std::string& file, const std::string& type = "spectrum") {
  return "Texture \"t\" \"" + type + "\" \"imagemap\" \"string filename\" \"" + file + "\"";
}

TEST(PbrtMissingParts, EndsOfDirectives) {
  const SceneDescription scene = pbrt_world("AttributeBegin\nTransformBegin Shape \"sphere\"");
  EXPECT_EQ(scene.shapes.size(), 1u);
  EXPECT_EQ(warnings_of(scene),
            "scene.pbrt:2: AttributeBegin has no end; it ends with the file\n"
            "scene.pbrt:3: TransformBegin has no end; it ends with the file\n");
  EXPECT_EQ(told_of(kPbrtTriangle + "ObjectBegin \"o\""),
            "scene.pbrt:3: ObjectBegin has no end; it ends with the file\n");
}

TEST(PbrtMissingParts, EndsOfDirectivesInImportedFiles) {
  const SceneDescription scene =
      pbrt_world("AttributeBegin Import \"part.pbrt\" AttributeEnd Shape \"sphere\"",
                 {{"part.pbrt", "ObjectBegin \"o\"\nTransformBegin Shape \"sphere\""}});
  EXPECT_EQ(warnings_of(scene),
            "part.pbrt:1: ObjectBegin has no end; it ends with the file\n"
            "part.pbrt:2: TransformBegin has no end; it ends with the file\n");
  EXPECT_EQ(scene.shapes.size(), 1u);
}

// Uses of the same one are counted.
TEST(PbrtMissingParts, EachOneIsNamed) {
  EXPECT_EQ(told_of("NamedMaterial \"a\" Shape \"sphere\"\nNamedMaterial \"b\" Shape \"sphere\"\n"
                    "NamedMaterial \"a\" Shape \"sphere\" Material \"diffuse\""),
            "scene.pbrt:2: there is no material 'a'; gray is used (2 times)\n"
            "scene.pbrt:3: there is no material 'b'; gray is used\n");
  EXPECT_EQ(told_of("ObjectInstance \"o\"\nObjectInstance \"p\""),
            "scene.pbrt:2: there is no object 'o'; it is left out\n"
            "scene.pbrt:3: there is no object 'p'; it is left out\n");
  EXPECT_EQ(told_of("MediumInterface \"fog\" \"air\""),
            "scene.pbrt:3: there is no medium 'fog'; vacuum is used\n"
            "scene.pbrt:3: there is no medium 'air'; vacuum is used\n");
  const std::string told =
      told_of("Material \"conductor\" \"spectrum eta\" \"a.spd\" \"spectrum k\" \"b.spd\"");
  for (const char* each : {"there is no spectrum 'a.spd'", "there is no spectrum 'b.spd'",
                           "the colour 'eta' is not understood", "the colour 'k' is not understood"})
    EXPECT_THAT(told, HasSubstr(each));
}

// Gray would be half transparent.
TEST(PbrtMissingParts, AlphaThatCannotBeReadIsOpaque) {
  const auto opacity_of = [](const SceneDescription& scene) {
    return scene.materials.at(std::get<SphereDescription>(scene.shapes.at(0)).material).opacity;
  };
  const std::string sphere = "\nShape \"sphere\" \"texture alpha\" \"t\"";
  const SceneDescription no_image = pbrt_world(image_texture("gone.png", "float") + sphere);
  EXPECT_EQ(opacity_of(no_image).value, 1);
  EXPECT_THAT(
      warnings_of(no_image),
      HasSubstr("scene.pbrt:3: the texture 't', or a part of it, cannot be read; the surface is opaque\n"));
  const SceneDescription scaled =
      pbrt_world(image_texture("gone.png", "float") +
                 "\nTexture \"half\" \"float\" \"scale\" \"texture tex\" \"t\" \"float scale\" 0.5"
                 "\nShape \"sphere\" \"texture alpha\" \"half\"");
  EXPECT_EQ(opacity_of(scaled).value, 1);
  EXPECT_THAT(warnings_of(scaled), HasSubstr("the texture 'half', or a part of it, cannot be read"));
  const SceneDescription no_texture = pbrt_world(sphere);
  EXPECT_EQ(opacity_of(no_texture).value, 1);
  EXPECT_EQ(warnings_of(no_texture), "scene.pbrt:3: there is no texture 't'; the surface is opaque\n");
}

TEST(PbrtMissingParts, FoldersOfWindows) {
  const MemoryAssets::Files files{{"tex/new/a.png", png(one_color(2, 2, Rgb{1, 0, 0}))}};
  EXPECT_EQ(told_of(image_texture("tex\\new\\a.png"), files),
            "scene.pbrt:2: 'tex\\new\\a.png' does not exist; 'tex/new/a.png' is used\n");
  EXPECT_EQ(told_of(image_texture("tex\\\\new\\\\a.png"), files),
            "scene.pbrt:2: 'tex\\new\\a.png' does not exist; 'tex/new/a.png' is used\n");
  EXPECT_EQ(told_of(image_texture("tex\\new\\b.png"), files),
            "scene.pbrt:2: the image 'tex\\new\\b.png' does not exist; gray is used\n");
  EXPECT_EQ(told_of("Include \"parts\\new.pbrt\"", {{"parts/new.pbrt", ""}}),
            "scene.pbrt:2: 'parts\\new.pbrt' does not exist; 'parts/new.pbrt' is used\n");
}

TEST(PbrtMissingParts, NamesInAnotherLetterCaseAreToldOnce) {
  const MemoryAssets::Files files{{"scene.pbrt", "WorldBegin\n" + image_texture("A.PNG") +
                                                     "\nTexture \"n\" \"float\" \"imagemap\" "
                                                     "\"string filename\" \"A.PNG\"\nInclude \"Part.pbrt\""},
                                  {"part.pbrt", kPbrtTriangle},
                                  {"a.png", png(one_color(2, 2, Rgb{1, 0, 0}))}};
  BundleAssets assets({"scene.pbrt", "part.pbrt", "a.png"},
                      [&](const std::string& name, const std::string&) { return files.at(name); });
  const auto scene = load_scene(assets, "scene.pbrt", "scene.pbrt");
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(warnings_of(*scene),
            "scene.pbrt:2: 'A.PNG' does not exist; 'a.png' is used\n"
            "scene.pbrt:4: 'Part.pbrt' does not exist; 'part.pbrt' is used\n");
}

TEST(PbrtMissingParts, NamesOfFilesAndTypes) {
  EXPECT_EQ(told_of("Shape \"plymesh\""),
            "scene.pbrt:2: the shape 'plymesh' has no file name; it is left out\n");
  EXPECT_EQ(told_of("Texture \"t\" \"spectrum\" \"imagemap\""),
            "scene.pbrt:2: the texture 'imagemap' has no file name; gray is used\n");
  const std::string material = "MakeNamedMaterial \"a\" \"rgb reflectance\" [1 0 0]\nNamedMaterial \"a\"";
  EXPECT_EQ(told_of(material), "scene.pbrt:2: the material 'a' has no type; a diffuse one is used\n");
  EXPECT_EQ(std::get<Lambert>(pbrt_material(material).model).albedo.value, (Rgb{1, 0, 0}));
}

TEST(PbrtMissingParts, IndicesOfTriangles) {
  const SceneDescription scene =
      pbrt_world("Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]\n" + kPbrtTriangle);
  EXPECT_EQ(warnings_of(scene), "scene.pbrt:2: the shape 'trianglemesh' has no indices; it is left out\n");
  EXPECT_EQ(scene.shapes.size(), 1u);
}

}  // namespace
}  // namespace tessera::core::test
