// SPDX-License-Identifier: Apache-2.0
// An editor that knows the JSON Schema names the wrong key, and no other.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>
#include <vector>

namespace tessera::core {
namespace {

using nlohmann::json;
using Adapter = valijson::adapters::NlohmannJsonAdapter;

json read_json(const std::filesystem::path& path) {
  return json::parse(std::ifstream(path), nullptr, true, /*ignore_comments=*/true);
}

const valijson::Schema& parsed_schema() {
  static valijson::Schema schema;
  json document = read_json(TESSERA_SOURCE_DIR "/scenes/scene.schema.json");
  document.erase("$id");  // nothing is fetched
  valijson::SchemaParser(valijson::SchemaParser::kDraft7).populateSchema(Adapter(document), schema);
  return schema;
}

// Where the schema finds mistakes, innermost place first: "materials.m: ... 'albdo'".
std::vector<std::string> messages_for(const json& scene) {
  static const valijson::Schema& schema = parsed_schema();
  valijson::ValidationResults results;
  valijson::Validator(valijson::Validator::kStrongTypes).validate(schema, Adapter(scene), &results);
  std::vector<std::string> messages;
  for (valijson::ValidationResults::Error error; results.popError(error);) {
    std::string place;
    for (const std::string& part : error.context) place += part;
    messages.push_back(place + ": " + error.description);
  }
  return messages;
}

json scene_with(const std::string& material, const std::string& shape) {
  json scene = json::parse(R"({"camera": {"position": [0, 0, 5], "look_at": [0, 0, 0]}})");
  scene["materials"] = {{"m", json::parse(material)}};
  scene["shapes"] = json::array({json::parse(shape)});
  return scene;
}

constexpr const char* kLambert = R"({"type": "lambert", "albedo": 0.5})";
constexpr const char* kSphere = R"({"type": "sphere", "radius": 1, "material": "m"})";

// The first message is at `place` and speaks of `key`.
void expect_message(const json& scene, const std::string& place, const std::string& key) {
  const std::vector<std::string> messages = messages_for(scene);
  ASSERT_FALSE(messages.empty()) << scene;
  EXPECT_TRUE(messages.front().starts_with("<root>" + place + ": ")) << messages.front();
  EXPECT_NE(messages.front().find(key), std::string::npos) << messages.front();
}

TEST(SchemaMessages, AreNoneForTheScenesOfTheRepository) {
  EXPECT_EQ(messages_for(scene_with(kLambert, kSphere)), std::vector<std::string>());
  int scenes = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(TESSERA_SOURCE_DIR "/scenes")) {
    if (entry.path().extension() != ".json" || entry.path().filename() == "scene.schema.json") continue;
    EXPECT_EQ(messages_for(read_json(entry.path())), std::vector<std::string>()) << entry.path();
    ++scenes;
  }
  EXPECT_GE(scenes, 13);
}

TEST(SchemaMessages, NameTheWrongKeyOfAMaterial) {
  expect_message(scene_with(R"({"type": "lambert", "albdo": 0.5})", kSphere), "[materials][m]", "albdo");
  expect_message(scene_with(R"({"type": "glass", "albedo": 0.5})", kSphere), "[materials][m]", "albedo");
  expect_message(scene_with(R"({"type": "mirror", "reflectance": {"textur": "t"}})", kSphere),
                 "[materials][m][reflectance]", "textur'");
}

TEST(SchemaMessages, NameTheWrongKeyOfAShapeAndALight) {
  expect_message(
      scene_with(kLambert, R"({"type": "sphere", "radius": 1, "material": "m", "centre": [0, 0, 0]})"),
      "[shapes][0]", "centre");
  expect_message(scene_with(kLambert, R"({"type": "quad", "corner": [0, 0, 0], "material": "m"})"),
                 "[shapes][0]", "edge_u");
  json scene = scene_with(kLambert, kSphere);
  scene["lights"] =
      json::parse(R"([{"type": "point", "position": [0, 1, 0], "irradiance": 3, "intensity": 1}])");
  expect_message(scene, "[lights][0]", "irradiance");
  scene = scene_with(kLambert, kSphere);
  scene["objects"] = json::parse(R"({"o": {"shapes": [{"type": "mesh", "file": "a.obj", "radius": 1}]}})");
  expect_message(scene, "[objects][o][shapes][0]", "radius");
}

TEST(SchemaMessages, PointAtTheWrongValue) {
  expect_message(scene_with(R"({"type": "lambert", "albedo": 1.5})", kSphere), "[materials][m][albedo]", "1");
  expect_message(scene_with(R"({"type": "lambert", "albedo": [0, 2, 0]})", kSphere),
                 "[materials][m][albedo][1]", "1");
  expect_message(
      scene_with(R"({"type": "cook_torrance", "roughness": {"texture": "t", "scale": 2}})", kSphere),
      "[materials][m][roughness][scale]", "1");
  json scene = scene_with(kLambert, kSphere);
  scene["camera"]["aperture_blades"] = 2;
  expect_message(scene, "[camera][aperture_blades]", "3");
}

TEST(SchemaMessages, PointAtTheTypeThatThereIsNot) {
  expect_message(scene_with(R"({"type": "lambertian"})", kSphere), "[materials][m][type]", "enum");
  expect_message(scene_with(kLambert, R"({"type": "cube"})"), "[shapes][0][type]", "enum");
  expect_message(scene_with(R"({"albedo": 0.5})", kSphere), "[materials][m]", "type");
}

}  // namespace
}  // namespace tessera::core
