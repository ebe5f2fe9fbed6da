// Textures and materials of a scene file.
#include <fmt/format.h>

#include <algorithm>

#include "core/scene/loader/scene_file.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

using scene_keys::kColorSpaces;
using scene_keys::kEmissionSides;
using scene_keys::kMaterialTypes;
using scene_keys::kWraps;

using Words = std::span<const std::string_view>;

constexpr Bounds kIor{
    [](double v) { return v >= 1 && v <= 10; },
    "between 1 and 10 (it is that of the inside; for air in glass, turn the surface inside out)"};

// A number, [r, g, b], or {"texture": NAME, "tint": ...} with the keys of `textured`.
ColorParameter read_color_parameter(const Field& field, const std::vector<TextureEntry>& textures,
                                    const Bounds& bounds, const ObjectRules& textured) {
  if (!field.value().get_if<JsonValue::Object>()) return {read_color(field, bounds), -1};
  const ObjectReader object(field, textured);
  ColorParameter color;
  color.value = read_or(object, "tint", color.value, read_color, bounds);
  color.texture = read_or(object, "texture", color.texture, read_texture_name, textures);
  return color;
}

// How much a surface reflects or lets through.
ColorParameter read_share(const Field& field, const std::vector<TextureEntry>& textures) {
  return read_color_parameter(field, textures, bounds::kUnit, scene_keys::kTexturedColor);
}

MaterialModel read_model(const Field& field, std::size_t type, const std::vector<TextureEntry>& textures) {
  const auto share = [&](const ObjectReader& object, std::string_view key, ColorParameter otherwise) {
    return read_or(object, key, otherwise, read_share, textures);
  };
  if (type == 0) {
    const ObjectReader object(field, scene_keys::kLambert);
    return Lambert{share(object, "albedo", Lambert{}.albedo)};
  }
  if (type == 1) {
    const ObjectReader object(field, scene_keys::kMirror);
    return Mirror{share(object, "reflectance", Mirror{}.reflectance)};
  }
  const ObjectReader object(field, scene_keys::kGlass);
  return Glass{read_or(object, "ior", Glass{}.ior, read_float, kIor),
               share(object, "reflectance", Glass{}.reflectance),
               share(object, "transmittance", Glass{}.transmittance)};
}

Material read_material(const Field& field, const std::string& name,
                       const std::vector<TextureEntry>& textures) {
  const auto type = read_type(field, kMaterialTypes, "material");
  if (!type) return {name, Lambert{}};
  Material material{name, read_model(field, *type, textures)};
  // The model's reader has told unknown keys already.
  if (const auto emission = find_member_field(field, "emission"))
    material.emission =
        read_color_parameter(*emission, textures, bounds::kNotNegative, scene_keys::kTexturedEmission);
  if (const auto sides = find_member_field(field, "emission_sides"))
    material.two_sided_emission = read_choice(*sides, Words(kEmissionSides)) == 0;
  return material;
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
    texture.wrap = read_or(object, "wrap", texture.wrap, read_choice, Words(kWraps));
    texture.scale = read_or(object, "scale", texture.scale, read_vec2, bounds::kAny);
    texture.offset = read_or(object, "offset", texture.offset, read_vec2, bounds::kAny);
    textures.push_back(std::move(texture));
  }
  return textures;
}

std::vector<MaterialEntry> read_materials(const Field& field, const std::vector<TextureEntry>& textures) {
  std::vector<MaterialEntry> materials;
  for (const auto& [name, entry] : read_named(field))
    materials.push_back({read_material(entry, name, textures), entry.place()});
  return materials;
}

}  // namespace tessera::core
