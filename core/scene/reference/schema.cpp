// SPDX-License-Identifier: Apache-2.0
#include "core/scene/reference/schema.hpp"

#include <cctype>
#include <cmath>
#include <map>

#include "core/scene/reference/all_tables.hpp"
#include "core/scene/reference/json_layout.hpp"
#include "core/scene/reference/key_json.hpp"

namespace tessera::core {
namespace {

using Json = OrderedJson;

Json reference(std::string_view definition) {
  return {{"$ref", fmt::format("#/$defs/{}", definition)}};
}

// "a medium" for "a [medium](#media)".
std::string without_links(std::string text) {
  for (auto middle = text.find("]("); middle != std::string::npos; middle = text.find("](")) {
    text.erase(middle, text.find(')', middle) - middle + 1);
    text.erase(text.rfind('[', middle), 1);
  }
  return text;
}

// The sentence of a key without marks: "The index of refraction."
std::string sentence(std::string_view documentation) {
  std::string text = without_links(std::string(documentation));
  std::erase_if(text, [](char c) { return c == '`' || c == '*'; });
  text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text + ".";
}

Json limit_json(double limit) {
  constexpr double kLongest = 1e6;
  const bool is_short = limit == std::floor(limit) && std::fabs(limit) <= kLongest;
  return is_short ? Json(static_cast<std::int64_t>(limit)) : Json(limit);
}

void add_limits(const Range& range, Json& schema) {
  if (range.has_min()) schema[range.excludes_min ? "exclusiveMinimum" : "minimum"] = limit_json(range.min);
  if (range.has_max()) schema[range.excludes_max ? "exclusiveMaximum" : "maximum"] = limit_json(range.max);
}

Json number_schema(const Range& range, std::string_view type = "number") {
  Json schema{{"type", type}};
  add_limits(range, schema);
  return schema;
}

// A number for gray, or three.
Json color_schema(const Range& range) {
  Json schema{{"description", "Red, green and blue."}, {"type", {"number", "array"}}};
  add_limits(range, schema);
  schema.update({{"items", number_schema(range)}, {"minItems", 3}, {"maxItems", 3}});
  return schema;
}

Json or_keyframes(const Json& schema) {
  return {{"if", reference("has_keyframes")}, {"then", reference("animated")}, {"else", schema}};
}

Json words_schema(const Domain& domain) {
  Json words = Json::array();
  for (const std::string_view word : domain.words) words.push_back(word);
  return {{"enum", words}};
}

// The keys of an object.
struct Keys {
  Json properties = Json::object(), required = Json::array();
};

// Of an object whose type decides its keys.
Keys keys_of_type(std::string_view word) {
  return {.properties = {{"type", {{"const", word}}}}, .required = Json::array({"type"})};
}

void set_keys(const Keys& keys, Json& object) {
  if (keys.required.empty()) {
    object.erase("required");
  } else {
    object["required"] = keys.required;
  }
  object["properties"] = keys.properties;
}

class SchemaWriter {
 public:
  explicit SchemaWriter(std::string_view schema) : schema_(Json::parse(schema)) {}

  UpdatedSchema update();

 private:
  Json& definition(std::string_view name) { return schema_["$defs"][std::string(name)]; }
  // References end with the next definition.
  Json& object_at(const std::string& pointer) {
    objects_.insert(pointer);
    return schema_[nlohmann::json_pointer<std::string>(pointer)];
  }

  // The definitions of a parameter: its constant, and its texture with a factor. Returns a reference to both.
  Json parameter_schema(const Domain& domain, const Json& constant, std::string_view kind,
                        std::string_view factor);
  template <typename Value>
  Json object_schema(const Domain& domain);
  template <typename Value>
  Json value_schema(const Domain& domain);
  template <typename Owner, typename Entry>
  Json property(const Entry& entry);
  template <typename Owner, typename... Entries>
  void add_keys(const Table<Entries...>& table, Keys& keys);
  template <typename Owner>
  void set_object(const std::string& pointer, Keys keys = {});
  void define_common_keys();

  Json schema_;
  std::set<std::string> objects_;
  // The domains of keys that have a definition of their own, by name.
  std::map<std::string_view, const Domain*> common_;
};

Json SchemaWriter::parameter_schema(const Domain& domain, const Json& constant, std::string_view kind,
                                    std::string_view factor) {
  const std::string of_constant = fmt::format("{}_{}", domain.definition, kind);
  const std::string textured = fmt::format("textured_{}", domain.definition);
  definition(of_constant) = constant;
  Json factors = or_keyframes(reference(of_constant));
  factors["default"] = 1;
  object_at("/$defs/" + textured) = {
      {"description",
       kind == "color" ? "A texture times a colour." : "The red channel of a texture times a number."},
      {"type", "object"},
      {"required", Json::array({"texture"})},
      {"additionalProperties", false},
      {"properties", {{"texture", reference("texture_name")}, {std::string(factor), factors}}}};
  Json types = constant["type"].is_array() ? constant["type"] : Json::array({constant["type"]});
  types.push_back("object");
  Json both{{"type", types}};
  both.update(or_keyframes(
      {{"if", {{"type", "object"}}}, {"then", reference(textured)}, {"else", reference(of_constant)}}));
  definition(domain.definition) = both;
  return reference(domain.definition);
}

template <typename Value>
Json SchemaWriter::object_schema(const Domain& domain) {
  Keys keys;
  add_keys<Value>(kKeys<Value>, keys);
  Json object{{"type", "object"}, {"required", Json::array()}, {"additionalProperties", false}};
  set_keys(keys, object);
  if (domain.definition.empty()) return object;
  Json& defined = object_at(fmt::format("/$defs/{}", domain.definition));
  if (defined.is_null()) defined = object;
  set_keys(keys, defined);
  return reference(domain.definition);
}

template <typename Value>
Json SchemaWriter::value_schema(const Domain& domain) {
  if constexpr (std::same_as<Value, ColorParameter>) {
    return parameter_schema(domain, color_schema(domain.range), "color", "tint");
  } else if constexpr (std::same_as<Value, ScalarParameter>) {
    return parameter_schema(domain, number_schema(domain.range), "number", "scale");
  } else if constexpr (HasTable<Value>) {
    return object_schema<Value>(domain);
  }
  if (!domain.words.empty()) {
    if (domain.definition.empty()) return words_schema(domain);
    definition(domain.definition) = words_schema(domain);
  }
  if (!domain.definition.empty()) return reference(domain.definition);
  if constexpr (std::same_as<Value, bool>) return {{"type", "boolean"}};
  if (domain.range.or_zero)
    return {{"if", {{"not", {{"const", 0}}}}}, {"then", number_schema(domain.range, "integer")}};
  return number_schema(domain.range, std::same_as<Value, int> ? "integer" : "number");
}

template <typename Owner, typename Entry>
Json SchemaWriter::property(const Entry& entry) {
  Json property{{"description", sentence(entry.documentation)}}, schema;
  if constexpr (MemberOf<Entry, Owner>) {
    schema = value_schema<std::remove_cvref_t<decltype(entry.of(std::declval<Owner&>()))>>(entry.domain);
  } else {
    schema = value_schema<void>(entry.domain);
  }
  property.update(entry.traits.has_keyframes ? or_keyframes(schema) : schema);
  if (const Json standard = default_json<Owner>(entry); !standard.is_null()) property["default"] = standard;
  return property;
}

template <typename Owner, typename... Entries>
void SchemaWriter::add_keys(const Table<Entries...>& table, Keys& keys) {
  for_each(table, [&]<typename Entry>(const Entry& entry) {
    if constexpr (Named<Entry>) {
      const std::string name(entry.name);
      if (entry.traits.required) keys.required.push_back(name);
      const auto common = std::same_as<Owner, Material> ? common_.find(entry.name) : common_.end();
      const bool is_common = common != common_.end() && common->second == &entry.domain;
      keys.properties[name] = is_common ? reference(name) : property<Owner>(entry);
    }
  });
}

template <typename Owner>
void SchemaWriter::set_object(const std::string& pointer, Keys keys) {
  add_keys<Owner>(kKeys<Owner>, keys);
  set_keys(keys, object_at(pointer));
}

// Models refer to one definition of each.
void SchemaWriter::define_common_keys() {
  for_each(kKeys<Material>, [&]<typename Entry>(const Entry& entry) {
    if constexpr (Named<Entry>) {
      const Json schema = property<Material>(entry);
      definition(entry.name) = schema;
      if (schema.contains("properties")) objects_.insert(fmt::format("/$defs/{}", entry.name));
      common_[entry.name] = &entry.domain;
    }
  });
}

UpdatedSchema SchemaWriter::update() {
  define_common_keys();
  for_each_type<MaterialModel>(scene_keys::kMaterialTypes,
                               [&]<typename Model>(std::type_identity<Model>, std::string_view word) {
                                 Keys keys = keys_of_type(word);
                                 add_keys<Model>(kKeys<Model>, keys);
                                 add_keys<Material>(kCommonKeys<Model>, keys);
                                 set_keys(keys, object_at(fmt::format("/$defs/{}", word)));
                               });
  for_each_type<Pattern>(scene_keys::kPatternTypes,
                         [&]<typename Kind>(std::type_identity<Kind>, std::string_view word) {
                           Keys keys = keys_of_type(word);
                           add_keys<Kind>(kKeys<Kind>, keys);
                           add_keys<ProceduralTexture>(kKeys<ProceduralTexture>, keys);
                           set_keys(keys, object_at(fmt::format("/$defs/{}_texture", word)));
                         });
  for_each_type<LightDescription>(scene_keys::kLightTypes,
                                  [&]<typename Light>(std::type_identity<Light>, std::string_view word) {
                                    set_object<Light>(fmt::format("/$defs/{}", word), keys_of_type(word));
                                  });
  for_each_type<ShapeKeys>(scene_keys::kShapeTypes,
                           [&]<typename Shape>(std::type_identity<Shape>, std::string_view word) {
                             set_object<Shape>(fmt::format("/$defs/{}", word), keys_of_type(word));
                           });
  set_object<CameraDescription>("/properties/camera");
  set_object<MediumDescription>("/$defs/medium");
  set_object<EnvironmentDescription>("/properties/environment");
  return {json_layout(schema_) + "\n", objects_};
}

}  // namespace

UpdatedSchema update_schema(std::string_view schema) {
  return SchemaWriter(schema).update();
}

}  // namespace tessera::core
