// SPDX-License-Identifier: Apache-2.0
// Reads textures and materials of a scene file.
#include <fmt/format.h>

#include <algorithm>
#include <concepts>
#include <set>

#include "core/scene/loader/scene_file.hpp"
#include "core/scene/loader/table_reader.hpp"
#include "core/scene/loader/wording.hpp"
#include "core/scene/tables/material_tables.hpp"

namespace tessera::core {
namespace {

using scene_keys::kChannels;
using scene_keys::kColorSpaces;
using scene_keys::kMaterialTypes;
using scene_keys::kTextureFilters;
using scene_keys::kUvSets;
using scene_keys::kWraps;

using Words = std::span<const std::string_view>;

// The key, with its default if the file does not set it: 'specular'.
std::string name_with_default(const TableReader& read, std::string_view key, const ColorParameter& value) {
  return read.find(key) ? in_quotes(key) : fmt::format("{} ({} unless given)", in_quotes(key), value.value.r);
}

// Rejects surfaces that reflect more than they receive. Textures are clamped when they are evaluated.
void check_sum(const TableReader& read, const ColorParameter& diffuse, const ColorParameter& specular) {
  if (diffuse.texture >= 0 || specular.texture >= 0) return;
  const float sum = max_component(diffuse.value + specular.value);
  constexpr float kRounding = 1e-6f;
  if (sum > 1 + kRounding)
    read.field().mistake(fmt::format(
        "{} and {} add up to {:.6g}, and nothing reflects more than 1; lower one of them",
        name_with_default(read, "diffuse", diffuse), name_with_default(read, "specular", specular), sum));
}

using Above = std::vector<MaterialEntry>;

// What the table of a model does not tell: relations between keys, and keys without a member.
template <typename Model>
void finish(const TableReader&, Model&, const Above&) {}

void finish(const TableReader& read, Phong& model, const Above&) {
  check_sum(read, model.diffuse, model.specular);
}

void finish(const TableReader& read, CookTorrance& model, const Above&) {
  if (const auto metal = read.find("conductor"); metal && read.find("f0"))
    metal->mistake("a conductor has its own reflectance; leave 'f0' out, or this");
  check_sum(read, model.diffuse, model.specular);
}

void finish(const TableReader& read, ConductorMaterial& model, const Above&) {
  const auto metal = read.find("metal");
  if (!metal) return;
  const auto index = complex_index(static_cast<Conductor>(read_choice(*metal, scene_keys::kConductors)));
  model.eta = {index.eta, -1};
  model.k = {index.k, -1};
  if (read.find("eta") || read.find("k")) metal->mistake("a metal has its own 'eta' and 'k'; leave them out");
}

// What is given tells the pigment.
void finish(const TableReader& read, Hair& model, const Above&) {
  const auto reflectance = read.find("reflectance"), sigma_a = read.find("sigma_a");
  const bool has_melanin = read.find("eumelanin") || read.find("pheomelanin");
  if (sigma_a) model.pigment = HairPigment::kAbsorption;
  if (reflectance) model.pigment = HairPigment::kReflectance;
  if ((reflectance ? 1 : 0) + (sigma_a ? 1 : 0) + (has_melanin ? 1 : 0) > 1)
    (reflectance ? reflectance : sigma_a)
        ->mistake("hair has one of 'reflectance', 'sigma_a' and melanin; leave the others out");
}

// The index of a material above a blend.
std::uint32_t read_part(const Field& field, const std::vector<MaterialEntry>& above) {
  const std::string name = read_text(field);
  const auto found = std::find_if(above.begin(), above.end(),
                                  [&](const auto& entry) { return entry.material.name == name; });
  if (found != above.end()) return static_cast<std::uint32_t>(found - above.begin());
  std::vector<std::string_view> known;
  for (const auto& entry : above) known.push_back(entry.material.name);
  if (!name.empty())
    field.mistake(
        fmt::format("there is no material {} above this blend{}", in_quotes(name), suggestion(name, known)));
  return 0;
}

void finish(const TableReader& read, Blend& model, const Above& above) {
  const auto parts = read.find("materials");
  if (!parts) return;
  const auto* names = parts->value().get_if<JsonValue::Array>();
  if (names == nullptr || names->size() != 2) {
    parts->must_be("a list of 2 names of materials");
    return;
  }
  model.first = read_part(parts->element(0), above);
  model.second = read_part(parts->element(1), above);
}

// Keyframes are added to `tracks`.
Material read_material(const Field& field, const std::string& name, const KnownNames& names,
                       const Above& above, ParameterTracks& tracks) {
  const auto type = read_type(field, kMaterialTypes, "material");
  if (!type) return {name, Lambert{}};
  Material material{name, alternative<MaterialModel>(*type)};
  const std::string kind = fmt::format("{} material", kMaterialTypes[*type]);
  std::visit(
      [&]<typename Model>(Model& model) {
        const TableReader read(field, kind, rules_of(kTypeKey, kKeys<Model>, kCommonKeys<Model>), names);
        read.read(kKeys<Model>, model, tracks);
        read.read(kCommonKeys<Model>, material, tracks);
        finish(read, model, above);
      },
      material.model);
  return material;
}

// The textures that are used as colours, and those used as numbers.
struct TextureUses {
  std::set<int> colors, numbers;

  template <typename Value>
  void add(const Value& value) {
    if constexpr (std::same_as<Value, ColorParameter>) colors.insert(value.texture);
    if constexpr (std::same_as<Value, ScalarParameter> || std::same_as<Value, NormalMap> ||
                  std::same_as<Value, BumpMap> || std::same_as<Value, TangentMap>)
      numbers.insert(value.texture);
  }
};

TextureUses uses_of(const SceneFile& scene) {
  TextureUses uses;
  if (scene.environment) uses.add(scene.environment->radiance);
  for (const auto& entry : scene.materials)
    visit_keys(entry.material, [&](const auto&, const auto& value) { uses.add(value); });
  return uses;
}

}  // namespace

int read_texture_name(const Field& field, const std::vector<TextureEntry>& textures) {
  const std::string name = read_text(field);
  const auto found =
      std::find_if(textures.begin(), textures.end(), [&](const auto& t) { return t.name == name; });
  if (found != textures.end()) return static_cast<int>(found - textures.begin());
  std::vector<std::string_view> known;
  for (const auto& texture : textures) known.push_back(texture.name);
  if (!name.empty())
    field.mistake(fmt::format("there is no texture {}{}", in_quotes(name), suggestion(name, known)));
  return -1;
}

std::vector<TextureEntry> read_textures(const Field& field) {
  std::vector<TextureEntry> textures;
  for (const auto& [name, entry] : read_named(field)) {
    const ObjectReader object(entry, scene_keys::kTexture);
    TextureEntry texture;
    texture.name = name;
    if (const auto file = object.find("file")) {
      texture.file = read_text(*file);
      texture.file_place = file->place();
    }
    if (const auto space = object.find("color_space"))
      texture.color_space = static_cast<ColorSpace>(read_choice(*space, Words(kColorSpaces)));
    texture.channel = read_or(object, "channel", texture.channel, read_choice, Words(kChannels));
    if (const auto layer = object.find("layer")) {
      texture.layer = read_text(*layer);
      if (texture.channel == TextureChannel::kAlpha) layer->mistake("a layer has no alpha; name its channel");
    }
    if (const auto space = object.find("color_space"); space && texture.channel == TextureChannel::kAlpha)
      space->mistake("alpha has no colour space; leave this out");
    texture.wrap = read_or(object, "wrap", texture.wrap, read_choice, Words(kWraps));
    texture.scale = read_or(object, "scale", texture.scale, read_vec2, ranges::kAny);
    texture.offset = read_or(object, "offset", texture.offset, read_vec2, ranges::kAny);
    if (const auto wrap = object.find("wrap_v"))
      texture.wrap_v = static_cast<Wrap>(read_choice(*wrap, Words(kWraps)));
    texture.shear = read_or(object, "shear", texture.shear, read_vec2, ranges::kAny);
    texture.uv_set = read_or(object, "uv_set", texture.uv_set, read_choice, Words(kUvSets));
    texture.filter = read_or(object, "filter", texture.filter, read_choice, Words(kTextureFilters));
    textures.push_back(std::move(texture));
  }
  return textures;
}

std::vector<MaterialEntry> read_materials(const Field& field, const std::vector<TextureEntry>& textures,
                                          const std::vector<MediumDescription>& media) {
  std::vector<MaterialEntry> materials;
  for (const auto& [name, entry] : read_named(field)) {
    ParameterTracks tracks;
    Material material =
        read_material(entry, name, {.textures = &textures, .media = &media}, materials, tracks);
    materials.push_back({std::move(material), entry.place(), std::move(tracks)});
  }
  return materials;
}

void settle_color_spaces(SceneFile& scene) {
  const TextureUses uses = uses_of(scene);
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    const auto index = static_cast<int>(i);
    auto& color_space = scene.textures[i].color_space;
    if (!color_space && uses.numbers.contains(index) && !uses.colors.contains(index))
      color_space = ColorSpace::kLinear;
  }
}

}  // namespace tessera::core
