// SPDX-License-Identifier: Apache-2.0
// The published JSON Schema and the loader must not drift apart.
#include <gtest/gtest.h>

#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "core/camera/camera_description.hpp"
#include "core/geometry/primitives.hpp"
#include "core/image/display.hpp"
#include "core/scene/loader/scene_keys.hpp"
#include "core/scene/reference/schema.hpp"
#include "core/scene/settings.hpp"

namespace tessera::core {
namespace {

using nlohmann::json;

json schema() {
  return json::parse(std::ifstream(TESSERA_SOURCE_DIR "/scenes/scene.schema.json"));
}

json at(const std::string& pointer) {
  return schema().at(json::json_pointer(pointer));
}

TEST(Schema, HasTheKeysThatTheLoaderKnows) {
  for (const ObjectRules& rules : scene_keys::kAllObjects) {
    const json object = at(std::string(rules.schema_pointer));
    std::set<std::string> known, required, in_schema, required_in_schema;
    for (const KeyRule& rule : rules.keys) {
      known.emplace(rule.name);
      if (rule.required) required.emplace(rule.name);
    }
    for (const auto& [key, value] : object.at("properties").items()) in_schema.insert(key);
    for (const auto& key : object.value("required", json::array())) required_in_schema.insert(key);
    EXPECT_EQ(in_schema, known) << rules.kind;
    EXPECT_EQ(required_in_schema, required) << rules.kind;
    EXPECT_EQ(object.at("additionalProperties"), false) << rules.kind;
  }
}

// Whether a node says what values have, and does not only look at their type to tell them apart.
bool describes_an_object(const json& node) {
  if (!node.is_object() || !node.contains("properties") || !node["properties"].is_object()) return false;
  return node["properties"].size() > 1 || !node["properties"].contains("type");
}

// Every object with properties of its own is one that the loader knows.
void collect_objects(const json& node, const std::string& pointer, std::set<std::string>& found) {
  if (describes_an_object(node)) found.insert(pointer);
  if (node.is_structured())
    for (const auto& [key, value] : node.items()) collect_objects(value, pointer + "/" + key, found);
}

TEST(Schema, HasNoObjectsThatTheLoaderDoesNotKnow) {
  std::set<std::string> found, known;
  collect_objects(schema(), "", found);
  for (const ObjectRules& rules : scene_keys::kAllObjects) known.emplace(rules.schema_pointer);
  known.merge(update_schema(schema().dump()).objects);
  EXPECT_EQ(found, known);
}

TEST(Schema, HasTheWordsThatTheLoaderKnows) {
  const auto expect_words = [](const std::string& pointer, std::span<const std::string_view> words) {
    EXPECT_EQ(at(pointer + "/enum").get<std::vector<std::string>>(),
              std::vector<std::string>(words.begin(), words.end()));
  };
  expect_words("/properties/render/properties/integrator", scene_keys::kIntegrators);
  expect_words("/properties/render/properties/layers/items/else", scene_keys::kLayers);
  expect_words("/properties/render/properties/filter", scene_keys::kFilters);
  expect_words("/properties/output/properties/tone_curve", scene_keys::kToneCurves);
  expect_words("/properties/render/properties/heuristic", scene_keys::kHeuristics);
  expect_words("/$defs/texture/properties/color_space", scene_keys::kColorSpaces);
  expect_words("/$defs/texture/properties/wrap", scene_keys::kWraps);
  expect_words("/$defs/texture/properties/wrap_v", scene_keys::kWraps);
  expect_words("/$defs/texture/properties/uv_set", scene_keys::kUvSets);
  expect_words("/$defs/texture/properties/filter", scene_keys::kTextureFilters);
  expect_words("/$defs/emission_sides", scene_keys::kSides);
  expect_words("/$defs/sides", scene_keys::kSides);
  expect_words("/$defs/shading_normals", scene_keys::kShadingNormals);
  expect_words("/$defs/mesh/properties/normals", scene_keys::kNormals);
  expect_words("/$defs/glass/properties/fresnel", scene_keys::kDielectricFresnels);
  expect_words("/$defs/phong/properties/lobe", scene_keys::kPhongLobes);
  expect_words("/$defs/cook_torrance/properties/conductor", scene_keys::kConductors);
  expect_words("/$defs/conductor/properties/metal", scene_keys::kConductors);
  expect_words("/$defs/cook_torrance/properties/masking", scene_keys::kMaskings);
  expect_words("/$defs/spot/properties/falloff", scene_keys::kSpotFalloffs);
  expect_words("/$defs/distribution", scene_keys::kDistributions);
  expect_words("/$defs/smith_masking", scene_keys::kSmithMaskings);
  expect_words("/$defs/cook_torrance/properties/sampling", scene_keys::kMicrofacetSamplings);
  expect_words("/$defs/sampling", scene_keys::kSamplings);
  const auto expect_types = [](std::span<const std::string_view> words) {
    for (const auto word : words)
      EXPECT_EQ(at("/$defs/" + std::string(word) + "/properties/type/const"), word);
  };
  expect_types(scene_keys::kMaterialTypes);
  expect_types(scene_keys::kShapeTypes);
  expect_types(scene_keys::kLightTypes);
}

// A key 'type' of one of `words` leads to the definition of that name.
void expect_choice(const std::string& pointer, std::span<const std::string_view> words) {
  const json node = at(pointer);
  const json& types = node.at("properties").at("type").at("enum");
  EXPECT_EQ(types.get<std::vector<std::string>>(), std::vector<std::string>(words.begin(), words.end()));
  ASSERT_EQ(node.at("allOf").size(), words.size()) << pointer;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const json& branch = node["allOf"][i];
    EXPECT_EQ(branch.at("if").at("required"), json::array({"type"}));
    EXPECT_EQ(branch["if"].at("properties").at("type").at("const"), words[i]);
    EXPECT_EQ(branch.at("then").at("$ref"), "#/$defs/" + std::string(words[i]));
  }
}

TEST(Schema, TellsObjectsApartByTheirType) {
  expect_choice("/$defs/material", scene_keys::kMaterialTypes);
  expect_choice("/$defs/shape", scene_keys::kShapeTypes);
  expect_choice("/$defs/light", scene_keys::kLightTypes);
}

TEST(Schema, HasTheLimitsAndDefaultsOfTheSettings) {
  const json render = at("/properties/render/properties");
  const RenderSettings defaults;
  EXPECT_EQ(render["width"]["maximum"], kMaxImageSidePx);
  EXPECT_EQ(render["height"]["maximum"], kMaxImageSidePx);
  EXPECT_EQ(render["spp"]["maximum"], kMaxSpp);
  EXPECT_EQ(render["seed"]["maximum"], ~std::uint64_t{0});
  EXPECT_EQ(render["width"]["default"], defaults.width_px);
  EXPECT_EQ(render["height"]["default"], defaults.height_px);
  EXPECT_EQ(render["spp"]["default"], defaults.spp);
  EXPECT_EQ(render["seed"]["default"], defaults.seed);
  EXPECT_EQ(render["max_depth"]["default"], defaults.max_depth);
  EXPECT_EQ(render["clamp_indirect"]["default"], defaults.clamp_indirect);
  EXPECT_EQ(render["integrator"]["default"], integrator_name(defaults.integrator));
  EXPECT_EQ(render["filter"]["default"], filter_name(defaults.filter.kind));
  EXPECT_EQ(render["filter_radius"]["maximum"], kMaxFilterRadiusPx);
  EXPECT_EQ(render["crop"]["items"]["maximum"], kMaxImageSidePx);
  const json output = at("/properties/output/properties");
  EXPECT_EQ(output["exposure"]["minimum"], -kMaxExposureStops);
  EXPECT_EQ(output["exposure"]["maximum"], kMaxExposureStops);
  EXPECT_EQ(output["exposure"]["default"], DisplaySettings{}.exposure_stops);
  EXPECT_EQ(output["tone_curve"]["default"], tone_curve_name(DisplaySettings{}.tone_curve));
  const json blades = at("/properties/camera/properties/aperture_blades")["then"];
  EXPECT_EQ(blades["minimum"], kMinApertureBlades);
  EXPECT_EQ(blades["maximum"], kMaxApertureBlades);
  EXPECT_EQ(render["heuristic"]["default"], heuristic_name(defaults.heuristic));
}

TEST(Schema, HasTheLimitOfCoordinates) {
  const json coordinate = at("/$defs/coordinate");
  EXPECT_EQ(coordinate["minimum"], -1e15);
  EXPECT_EQ(coordinate["maximum"], 1e15);
  EXPECT_EQ(static_cast<float>(coordinate["maximum"]), kMaxCoordinate);
}

// The loader's words stand in the order of the enum they stand for.
TEST(SceneKeys, NameIntegratorsAndHeuristicsInTheirOrder) {
  for (std::size_t i = 0; i < scene_keys::kIntegrators.size(); ++i)
    EXPECT_EQ(integrator_name(static_cast<Integrator>(i)), scene_keys::kIntegrators[i]);
  for (std::size_t i = 0; i < scene_keys::kHeuristics.size(); ++i)
    EXPECT_EQ(heuristic_name(static_cast<Heuristic>(i)), scene_keys::kHeuristics[i]);
}

TEST(SceneKeys, NameLayersInTheirOrder) {
  ASSERT_EQ(scene_keys::kLayers.size(), kLayerCount + 2);
  for (std::size_t i = 0; i < kLayerCount; ++i)
    EXPECT_EQ(layer_name(static_cast<Layer>(i)), scene_keys::kLayers[i]);
}

TEST(SceneKeys, NameTheFiltersAndToneCurvesInTheirOrder) {
  for (std::size_t i = 0; i < scene_keys::kFilters.size(); ++i)
    EXPECT_EQ(filter_name(static_cast<FilterKind>(i)), scene_keys::kFilters[i]);
  for (std::size_t i = 0; i < scene_keys::kToneCurves.size(); ++i)
    EXPECT_EQ(tone_curve_name(static_cast<ToneCurve>(i)), scene_keys::kToneCurves[i]);
}

TEST(Schema, RefersOnlyToDefinitionsThatExist) {
  const json root = schema();
  const std::function<void(const json&)> check = [&](const json& node) {
    if (node.is_object() && node.contains("$ref")) {
      EXPECT_TRUE(root.contains(json::json_pointer(node["$ref"].get<std::string>().substr(1))))
          << node["$ref"];
    }
    if (node.is_structured())
      for (const auto& item : node) check(item);
  };
  check(root);
}

}  // namespace
}  // namespace tessera::core
