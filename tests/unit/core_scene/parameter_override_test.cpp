// SPDX-License-Identifier: Apache-2.0
// Parameters of a scene file that are replaced by their paths.
#include "core/scene/loader/parameter_override.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core {
namespace {

constexpr const char* kText = R"({ // "camera": 3
  "camera": {"position": [0, 0, 5], /* here: */ "look_at": [0, 0, 0]},
  "lights": [{"type": "point", "position": [1, 2, 3], "intensity": 1},
             {"type": "point", "position": [4, 5, 6],
              "intensity": [1,
                            2, 3]}],
  "text": "a \" quote, } and ]", "empty": {}
})";

// The text with one parameter replaced, or the error.
std::string replaced(const std::string& text, const std::string& override_text) {
  const auto parsed = parse_override(override_text);
  if (!parsed) return parsed.error().message;
  const auto result = with_overrides(text, std::vector{*parsed});
  return result ? *result : result.error().message;
}

// The lines of kText with this one in place of the line with the number.
std::string with_line(std::size_t number, const std::string& line) {
  std::string text = kText;
  std::size_t begin = 0;
  for (std::size_t i = 1; i < number; ++i) begin = text.find('\n', begin) + 1;
  return text.replace(begin, text.find('\n', begin) - begin, line);
}

TEST(ParameterOverride, ReplacesAValueInItsPlace) {
  EXPECT_EQ(replaced(kText, "camera.position=[1, 2, 3]"),
            with_line(2, R"(  "camera": {"position": [1, 2, 3], /* here: */ "look_at": [0, 0, 0]},)"));
  EXPECT_EQ(replaced(kText, "camera.look_at[1]=0.5"),
            with_line(2, R"(  "camera": {"position": [0, 0, 5], /* here: */ "look_at": [0, 0.5, 0]},)"));
  EXPECT_EQ(replaced(kText, "lights[0].intensity=20"),
            with_line(3, R"(  "lights": [{"type": "point", "position": [1, 2, 3], "intensity": 20},)"));
  EXPECT_EQ(replaced(kText, "lights[1].position[2]=-1"),
            with_line(4, R"(             {"type": "point", "position": [4, 5, -1],)"));
  EXPECT_EQ(replaced(kText, "text=spot"), with_line(7, R"(  "text": "spot", "empty": {})"));
  EXPECT_EQ(replaced(kText, "text=\"two words\""), with_line(7, R"(  "text": "two words", "empty": {})"));
}

TEST(ParameterOverride, AddsWhatIsNotThere) {
  EXPECT_EQ(
      replaced(kText, "camera.aperture_radius=0.1"),
      with_line(
          2,
          R"(  "camera": {"aperture_radius": 0.1, "position": [0, 0, 5], /* here: */ "look_at": [0, 0, 0]},)"));
  EXPECT_EQ(replaced(kText, "empty.a.b=1"),
            with_line(7, R"(  "text": "a \" quote, } and ]", "empty": {"a": {"b": 1}})"));
  EXPECT_EQ(replaced("{}", "environment.radiance=1"), R"({"environment": {"radiance": 1}})");
}

// Places in messages are those of the file.
TEST(ParameterOverride, KeepsTheNumbersOfLines) {
  const std::string text = replaced(kText, "lights[1].intensity=7");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'),
            std::count(kText, kText + std::string(kText).size(), '\n'));
  EXPECT_NE(text.find("\"intensity\": 7\n}]"), std::string::npos) << text;
}

TEST(ParameterOverride, NamesThePathOfAMistake) {
  EXPECT_EQ(replaced(kText, "lights[2].intensity=1"),
            "lights[2].intensity: 'lights' has 2 elements, counted from 0");
  EXPECT_EQ(replaced(kText, "camera.position.x=1"),
            "camera.position.x: 'camera.position' is no object, so it has no keys");
  EXPECT_EQ(replaced(kText, "camera[0]=1"), "camera[0]: 'camera' is no list, so it has no elements");
  EXPECT_EQ(replaced(kText, "shapes[0].radius=1"), "shapes[0].radius: 'shapes' is not in the scene");
  EXPECT_EQ(replaced(kText, "camera.position=[1, 2"),
            "camera.position: the value must be written as in a scene file: a number, [x, y, z], \"a text\"; "
            "got '[1, 2'");
  EXPECT_EQ(replaced(kText, "camera.position=1 //"),
            "camera.position: the value must be written as in a scene file: a number, [x, y, z], \"a text\"; "
            "got '1 //'");
  for (const char* wrong : {"camera", "=3", ".camera=3", "camera.=3", "camera[x]=3", "camera[1=3", "a[0]b=3"})
    EXPECT_EQ(replaced(kText, wrong),
              std::string("must be PATH=VALUE such as camera.position=[0,1,5]; got '") + wrong + "'");
}

TEST(ParameterOverride, LeavesATextThatIsNoJsonToItsReader) {
  EXPECT_EQ(replaced("{\"a\": ", "a=1"), "{\"a\": ");
}

// The strict reader judges the values, and finds keys that do not exist.
TEST(ParameterOverride, IsReadAsIfItStoodInTheFile) {
  const auto mistake = [](const std::string& override_text) {
    test::MemoryAssets files({{"scene.json", test::scene_with("", "", "")}});
    OverriddenAssets assets(files, "scene.json", {*parse_override(override_text)});
    const auto loaded = load_scene(assets, "scene.json", "scene.json");
    return loaded ? "no mistake" : loaded.error().message;
  };
  EXPECT_EQ(mistake("camera.position=[1,2,3]"), "no mistake");
  EXPECT_EQ(mistake("camera.position=[1,2]"),
            "scene.json:1: camera.position: must be a list of 3 numbers, got a list of 2");
  EXPECT_EQ(mistake("camera.positon=[1,2,3]"),
            "scene.json:1: camera: unknown key 'positon'; did you mean 'position'?");
  EXPECT_EQ(mistake("shapes[7].radius=2"),
            "scene.json: shapes[7].radius: 'shapes' has 1 elements, counted from 0");
}

TEST(ParameterOverride, BecomesADefaultOfAMitsubaScene) {
  const std::string begin = "<?xml version='1.0'?>\n<!-- <scene> -->\n<scene version=\"3.0.0\">";
  const std::string end = "\n<default name=\"spp\" value=\"4\"/>\n<integer name=\"n\" value=\"$n\"/></scene>";
  EXPECT_EQ(replaced(begin + end, "spp=64"), begin + "<default name=\"spp\" value=\"64\"/>" + end);
  EXPECT_EQ(replaced(begin + end, "n=\"a <b>\""), begin + "<default name=\"n\" value=\"a &lt;b>\"/>" + end);
  EXPECT_EQ(replaced(begin + end, "n=[1, 0.5]"), begin + "<default name=\"n\" value=\"1, 0.5\"/>" + end);
  for (const std::string plain : {"0.1, 0.2 0.3", "#1010ff", "[0, 1", "a \\ //", ""})
    EXPECT_EQ(replaced(begin + end, "n=" + plain),
              begin + "<default name=\"n\" value=\"" + plain + "\"/>" + end);
  EXPECT_EQ(replaced(begin + end, "a.b=1"),
            "a.b: a Mitsuba scene has parameters with plain names, as -D spp=64");
}

// The scene read with a parameter replaced: its warnings, or the error.
std::string outcome(const std::string& name, const std::string& text, const std::string& override_text,
                    const test::MemoryAssets::Files& others = {}) {
  test::MemoryAssets::Files all = others;
  all[name] = text;
  test::MemoryAssets files(std::move(all));
  OverriddenAssets assets(files, name, {*parse_override(override_text)});
  const auto loaded = load_scene(assets, name, name);
  return loaded ? "read" : loaded.error().message;
}

TEST(ParameterOverride, OfAMitsubaSceneMustBeUsed) {
  const std::string scene =
      "<scene version=\"3.0.0\">\n<default name=\"radius\" value=\"4\"/><default name=\"idle\" value=\"1\"/>"
      "<shape type=\"sphere\"><float name=\"radius\" value=\"$radius\"/></shape></scene>";
  const auto of_scene = [&](const std::string& text) { return outcome("a.xml", scene, text); };
  EXPECT_EQ(of_scene("radius=2"), "read");
  EXPECT_EQ(of_scene("raduis=2"),
            "a.xml: raduis: nothing in the scene uses a parameter of this name; did you mean 'radius'?");
  EXPECT_EQ(of_scene("idle=2"),
            "a.xml: idle: nothing in the scene uses a parameter of this name; known is 'radius'");
  const std::string with_include = "<scene version=\"3.0.0\"><include filename=\"b.xml\"/></scene>";
  EXPECT_EQ(outcome("a.xml", with_include, "radius=2", {{"b.xml", scene}}), "read");
  EXPECT_EQ(outcome("a.xml", with_include, "radios=2", {{"b.xml", scene}}),
            "a.xml: radios: nothing in the scene uses a parameter of this name; did you mean 'radius'?");
}

TEST(ParameterOverride, OfAGltfFileMustBeUsed) {
  const std::string file =
      R"({"asset": {"version": "2.0", "generator": "x"}, "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0}}, {}],
"cameras": [{"type": "perspective", "perspective": {"yfov": 0.5}}], "nodes": [{"camera": 0}, {"mesh": 0}],
"meshes": [{"primitives": [{"material": 0, "attributes": {"POSITION": 0}}]}],
"accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
"bufferViews": [{"buffer": 0, "byteLength": 36}],
"buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
  const auto of_file = [&](const std::string& text) { return outcome("a.gltf", file, text); };
  EXPECT_EQ(of_file("cameras[0].perspective.yfov=0.7"), "read");
  EXPECT_EQ(of_file("materials[0].pbrMetallicRoughness.roughnessFactor=0.1"), "read");
  EXPECT_EQ(of_file("materials[0].emissiveFactor=[1,0,0]"), "read");
  EXPECT_EQ(
      of_file("cameras[0].perspective.yfvo=0.7"),
      "a.gltf: cameras[0].perspective.yfvo: nothing in the scene uses a parameter of this name; did you mean "
      "'cameras[0].perspective.yfov'?");
  for (const char* unused : {"materials[1].emissiveFactor=[1,0,0]", "asset.generator=y", "extras=1"})
    EXPECT_THAT(of_file(unused), testing::HasSubstr(": nothing in the scene uses a parameter of this name"));
}

TEST(ParameterOverride, IsRefusedForFormatsWithoutParameters) {
  test::MemoryAssets files(test::MemoryAssets::Files{{"a.pbrt", "WorldBegin"}});
  OverriddenAssets assets(files, "a.pbrt", {*parse_override("spp=64")});
  const auto text = assets.read("a.pbrt");
  ASSERT_FALSE(text);
  EXPECT_EQ(
      text.error().message,
      "'a.pbrt' has no parameters that -D can replace; those of .json, .gltf, .glb and Mitsuba's .xml files "
      "can be");
}

}  // namespace
}  // namespace tessera::core
