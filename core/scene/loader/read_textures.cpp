// SPDX-License-Identifier: Apache-2.0
// Reads textures of a scene file.
#include <fmt/format.h>

#include <algorithm>
#include <concepts>
#include <set>
#include <utility>

#include "core/scene/loader/scene_file.hpp"
#include "core/scene/loader/table_reader.hpp"
#include "core/scene/loader/wording.hpp"
#include "core/scene/tables/material_tables.hpp"
#include "core/scene/tables/texture_tables.hpp"

namespace tessera::core {
namespace {

using scene_keys::kChannels;
using scene_keys::kColorSpaces;
using scene_keys::kPatternTypes;
using scene_keys::kTextureFilters;
using scene_keys::kUvSets;
using scene_keys::kWraps;

using Words = std::span<const std::string_view>;

TextureEntry read_image(const Field& field) {
  const ObjectReader object(field, scene_keys::kTexture);
  TextureEntry texture;
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
  return texture;
}

// What the tables do not tell.
void finish(const TableReader& read, TextureEntry& texture) {
  if (const auto uv_set = read.find("uv_set"))
    texture.uv_set = static_cast<UvSet>(read_choice(*uv_set, Words(kUvSets)));
  const auto transform = read.find("transform");
  if (!transform) return;
  const TransformEntry entry = read_transform(*transform);
  if (!entry.motion.empty()) transform->mistake("the transform of a texture cannot be animated");
  texture.procedural->transform = entry.transform;
}

// Inputs are `above`.
TextureEntry read_procedural(const Field& field, const std::vector<TextureEntry>& above) {
  TextureEntry texture;
  texture.procedural.emplace();
  const auto type = read_type(field, kPatternTypes, "texture");
  if (!type) return texture;
  texture.procedural->pattern = alternative<Pattern>(*type);
  std::visit(
      [&]<typename Kind>(Kind& pattern) {
        const std::string kind = fmt::format("{} texture", kPatternTypes[*type]);
        const TableReader read(field, kind, rules_of(kTypeKey, kKeys<Kind>, kKeys<ProceduralTexture>),
                               {.textures = &above});
        ParameterTracks tracks;
        read.read(kKeys<Kind>, pattern, tracks);
        read.read(kKeys<ProceduralTexture>, *texture.procedural, tracks);
        finish(read, texture);
        if (!tracks.empty()) field.mistake("the numbers of a texture cannot be animated");
      },
      texture.procedural->pattern);
  return texture;
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
  for (const TextureEntry& entry : scene.textures)
    if (entry.procedural)
      visit_inputs(entry.procedural->pattern, [&](const auto& value) { uses.add(value); });
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
    TextureEntry texture =
        find_member_field(entry, "type") ? read_procedural(entry, textures) : read_image(entry);
    texture.name = name;
    textures.push_back(std::move(texture));
  }
  return textures;
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
