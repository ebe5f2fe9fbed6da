// SPDX-License-Identifier: Apache-2.0
// Every kind of mistake in a scene file as a whole, and in its files, and exactly what is said about it.
#include <gtest/gtest.h>

#include "tests/unit/core_scene/scene_mistakes.hpp"

namespace tessera::core {
namespace {

using test::MemoryAssets;
using test::mistakes_in;
using test::scene_with;
using test::with_camera;
using test::with_materials;
using test::with_render;
using test::with_shapes;
using test::with_textures;

TEST(SceneMistakes, NoneInTheScenesThatTheOthersAreMadeFrom) {
  EXPECT_EQ(mistakes_in(with_render("")), "no mistake");
  EXPECT_EQ(mistakes_in(with_textures("")), "no mistake");
  EXPECT_EQ(mistakes_in(with_camera("\"position\": [0, 0, 5], \"look_at\": [0, 0, 0]")), "no mistake");
}

TEST(SceneMistakes, OfTheWholeFile) {
  EXPECT_EQ(mistakes_in(""),
            "scene.json:1:1: not valid JSON: found the end of the file where a value is due");
  EXPECT_EQ(mistakes_in("\n[1, 2]"), "scene.json:2: must be an object in braces, got a list of 2");
  EXPECT_EQ(mistakes_in("{}"),
            "scene.json:1: a scene needs the key 'camera'\nscene.json:1: a scene needs the key 'shapes'");
  EXPECT_EQ(mistakes_in(scene_with("\"material\": {}", "", "")),
            "scene.json:2: unknown key 'material'; did you mean 'materials'?");
  EXPECT_EQ(mistakes_in(scene_with("\"$schema\": 3", "", "")),
            "scene.json:2: $schema: must be a text in double quotes, got 3");
  EXPECT_EQ(mistakes_in(scene_with("\"materials\": {}", "", "")),
            "scene.json:3: the key 'materials' is already there in line 2\n"
            "scene.json:4: shapes[0].material: there is no material 'light'");
}

TEST(SceneMistakes, AreAllToldInTheOrderOfTheFile) {
  EXPECT_EQ(
      mistakes_in(scene_with("\"render\": {\"spp\": 0, \"with\": 5},\n\"textures\": []",
                             "\"m\": {\"type\": \"mirror\", \"reflectance\": 2}", "{\"type\": \"quad\"}")),
      "scene.json:2: render: unknown key 'with'; did you mean 'width'?\n"
      "scene.json:2: render.spp: must be a whole number between 1 and 16777216, got 0\n"
      "scene.json:3: textures: must be an object in braces, from names to what they stand for, got a list of "
      "0\n"
      "scene.json:4: materials.m.reflectance: must be between 0 and 1, got 2\n"
      "scene.json:5: shapes[0]: a quad needs the key 'corner'\n"
      "scene.json:5: shapes[0]: a quad needs the key 'edge_u'\n"
      "scene.json:5: shapes[0]: a quad needs the key 'edge_v'\n"
      "scene.json:5: shapes[0]: a quad needs the key 'material'");
}

TEST(SceneMistakes, OfEveryAssetAreToldAtOnce) {
  EXPECT_EQ(
      mistakes_in(scene_with("\"textures\": {\"a\": {\"file\": \"a.png\"},\n\"b\": {\"file\": \"b.png\"}}",
                             "", "{\"type\": \"mesh\", \"file\": \"c.obj\", \"material\": \"light\"}")),
      "scene.json:2: textures.a.file: 'a.png' does not exist\n"
      "scene.json:3: textures.b.file: 'b.png' does not exist\n"
      "scene.json:5: shapes[0].file: 'c.obj' does not exist");
}

TEST(SceneMistakes, AreCutShortWhereThereAreVeryMany) {
  std::string materials = "\"m0\": {}";
  for (int i = 1; i < 1000; ++i) materials += ", \"m" + std::to_string(i) + "\": {}";
  const std::string message = mistakes_in(with_materials(materials));
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 20);
  EXPECT_TRUE(message.ends_with("\nscene.json: and 980 more mistakes")) << message;
}

TEST(SceneMistakes, HaveTheCodeOfTheFirst) {
  const auto code = [](const std::string& scene) { return test::load(scene).error().code; };
  EXPECT_EQ(code(with_render("\"spp\": 0")), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code(with_textures("\"a\": {\"file\": \"none.png\"}")), ErrorCode::kNotFound);
  EXPECT_EQ(code(with_textures("\"a\": {\"file\": \"triangle.obj\"}")), ErrorCode::kInvalidArgument);
}

std::string with_mesh(const std::string& more = "") {
  return with_shapes("{\"type\": \"mesh\", \"file\": \"m/a.obj\"" + more + "}");
}

TEST(SceneMistakes, InObjFiles) {
  const auto told = [](const std::string& obj) {
    return mistakes_in(with_mesh(", \"material\": \"light\""), {{"m/a.obj", obj}});
  };
  EXPECT_EQ(
      told("v 0 0 0\nv 1 nan 0\n"),
      "scene.json:4: shapes[0].file: m/a.obj: the file has no faces (no 'f' statement); is it complete?");
  EXPECT_EQ(told("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"),
            "scene.json:4: shapes[0].file: 'm/a.obj' has no face with an area greater than 0");
}

TEST(SceneMistakes, OfTexturesThatReflectMoreThanTheyGet) {
  const MemoryAssets::Files files{{"sky.hdr", test::hdr(test::one_color(8, 8, Rgb::gray(4)))}};
  const std::string textures = "\"textures\": {\"sky\": {\"file\": \"sky.hdr\"}}";
  const auto material = [](const std::string& tint) {
    return "\"m\": {\"type\": \"lambert\", \"albedo\": {\"texture\": \"sky\", \"tint\": " + tint + "}}";
  };
  EXPECT_EQ(
      mistakes_in(scene_with(textures, material("0.5"), ""), files),
      "scene.json:3: materials.m: the texture of material 'm' times 'tint' reaches 2, and nothing reflects "
      "more than 1");
  EXPECT_EQ(mistakes_in(scene_with(textures, material("0.25"), ""), files), "no mistake");
  EXPECT_EQ(
      mistakes_in(
          scene_with("\"textures\": {\"sky\": {\"file\": \"sky.hdr\", \"color_space\": \"srgb\"}}", "", ""),
          files),
      "scene.json:2: textures.sky.file: 'sky.hdr' has linear values, as all HDR, EXR and PFM images; leave "
      "'color_space' out");
}

}  // namespace
}  // namespace tessera::core
