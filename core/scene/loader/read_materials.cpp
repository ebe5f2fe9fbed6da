// SPDX-License-Identifier: Apache-2.0
// Reads textures and materials of a scene file.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <set>

#include "core/base/overloaded.hpp"
#include "core/scene/loader/scene_file.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

using scene_keys::kChannels;
using scene_keys::kColorSpaces;
using scene_keys::kMaterialTypes;
using scene_keys::kMicrofacetSamplings;
using scene_keys::kSamplings;
using scene_keys::kSides;
using scene_keys::kWraps;

using Words = std::span<const std::string_view>;

// The numbers that a parameter accepts, and the object that replaces a number to give a texture.
struct ScalarRules {
  Bounds limits;
  const ObjectRules& textured;
};

constexpr ScalarRules kIor{
    {[](double v) { return v >= 1 && v <= 10; },
     "between 1 and 10 (it is that of the inside; for air in glass, turn the surface inside out)"},
    scene_keys::kTexturedIor};
constexpr ScalarRules kRoughness{bounds::kUnit, scene_keys::kTexturedRoughness};
constexpr ScalarRules kExponent{{[](double v) { return v >= 0 && v <= 1e5; }, "between 0 and 100000"},
                                scene_keys::kTexturedExponent};
constexpr ScalarRules kOpacity{bounds::kUnit, scene_keys::kTexturedOpacity};
constexpr ScalarRules kLength{{[](double v) { return v >= 0 && v <= 1e15; }, "between 0 and 1e15"},
                              scene_keys::kTexturedLength};
constexpr Bounds kIndex{[](double v) { return v >= 0 && v <= 100; }, "between 0 and 100"};
constexpr Bounds kHairTilt{[](double v) { return v >= -20 && v <= 20; }, "between -20 and 20"};
constexpr Bounds kStrength{[](double v) { return v >= 0 && v <= 100; }, "between 0 and 100"};

constexpr std::string_view kTextureObject = "a texture as {\"texture\": \"NAME\"}";

bool is_text(const Field& field) {
  return field.value().get_if<std::string>() != nullptr;
}

// A number, [r, g, b], or {"texture": NAME, "tint": ...} with the keys of `textured`.
ColorParameter read_color_parameter(const Field& field, const std::vector<TextureEntry>& textures,
                                    const Bounds& bounds, const ObjectRules& textured, Track<Rgb>& track) {
  if (is_text(field)) {
    field.must_be(fmt::format("a number, a list of 3 numbers or {}", kTextureObject));
    return {};
  }
  if (!field.value().get_if<JsonValue::Object>() || has_keyframes(field))
    return {read_animated(field, track, read_color, bounds), -1};
  const ObjectReader object(field, textured);
  ColorParameter color;
  color.value = read_animated_or(object, "tint", color.value, track, read_color, bounds);
  color.texture = read_or(object, "texture", color.texture, read_texture_name, textures);
  return color;
}

// A number, or {"texture": NAME, "scale": ...}, which uses the red channel.
ScalarParameter read_scalar(const Field& field, const ScalarRules& rules,
                            const std::vector<TextureEntry>& textures, Track<float>& track) {
  if (is_text(field)) {
    field.must_be(fmt::format("{}, or {}", unquoted_number(rules.limits), kTextureObject));
    return 1;
  }
  if (!field.value().get_if<JsonValue::Object>() || has_keyframes(field))
    return read_animated(field, track, read_float, rules.limits);
  const ObjectReader object(field, rules.textured);
  ScalarParameter scalar = 1;
  scalar.value = read_animated_or(object, "scale", scalar.value, track, read_float, rules.limits);
  scalar.texture = read_or(object, "texture", scalar.texture, read_texture_name, textures);
  return scalar;
}

// A normal or bump map, and its factor.
struct MapRules {
  const ObjectRules& keys;
  std::string_view factor;
  Bounds limits;
};

constexpr MapRules kNormalMapRules{scene_keys::kNormalMap, "strength", kStrength};
constexpr MapRules kBumpRules{scene_keys::kBump, "height", bounds::kCoordinate};

template <typename Map>
Map read_map(const Field& field, const MapRules& rules, float Map::*factor,
             const std::vector<TextureEntry>& textures, Track<float>& track) {
  Map map;
  if (is_text(field)) {
    field.must_be(kTextureObject);
    return map;
  }
  const ObjectReader object(field, rules.keys);
  map.texture = read_or(object, "texture", map.texture, read_texture_name, textures);
  map.*factor = read_animated_or(object, rules.factor, map.*factor, track, read_float, rules.limits);
  return map;
}

// Reads the parameters of one material.
class ParameterReader {
 public:
  // Keyframes are added to `tracks`.
  ParameterReader(const Field& field, const ObjectRules& rules, const std::vector<TextureEntry>& textures,
                  ParameterTracks& tracks)
      : field_(field), object_(field, rules), textures_(textures), tracks_(tracks) {}

  ColorParameter color(std::string_view key, const ColorParameter& otherwise, const Bounds& limits,
                       const ObjectRules& textured) const {
    const auto field = find(key);
    if (!field) return otherwise;
    Track<Rgb> track;
    const ColorParameter value = read_color_parameter(*field, textures_, limits, textured, track);
    tracks_.add(key, std::move(track));
    return value;
  }
  // A reflectance or transmittance.
  ColorParameter share(std::string_view key, const ColorParameter& otherwise) const {
    return color(key, otherwise, bounds::kUnit, scene_keys::kTexturedColor);
  }
  ScalarParameter scalar(std::string_view key, const ScalarParameter& otherwise,
                         const ScalarRules& rules) const {
    const auto field = find(key);
    if (!field) return otherwise;
    Track<float> track;
    const ScalarParameter value = read_scalar(*field, rules, textures_, track);
    tracks_.add(key, std::move(track));
    return value;
  }
  template <typename Map>
  Map map(std::string_view key, const MapRules& rules, float Map::*factor) const {
    const auto field = find(key);
    if (!field) return {};
    Track<float> track;
    const Map value = read_map(*field, rules, factor, textures_, track);
    tracks_.add(key, std::move(track));
    return value;
  }
  template <typename Enum>
  Enum choice(std::string_view key, Enum otherwise, Words words) const {
    return read_or(object_, key, otherwise, read_choice, words);
  }
  bool truth(std::string_view key, bool otherwise) const {
    return read_or(object_, key, otherwise, read_bool);
  }
  // A constant of a conductor.
  ColorParameter index(std::string_view key, const ColorParameter& otherwise) const {
    return color(key, otherwise, kIndex, scene_keys::kTexturedIndex);
  }
  std::optional<Field> find(std::string_view key) const { return object_.find(key); }

  // Reads the parameters of `model` whose kind its key tells: an index of refraction, a length or a share.
  template <typename Model>
  void all(Model& model) const {
    visit_parameters(model, Overloaded{[&](std::string_view key, ScalarParameter& number) {
                                         number = scalar(key, number, rules_of(key));
                                       },
                                       [&](std::string_view key, ColorParameter& value) {
                                         const bool is_share = key != "eta" && key != "k" && key != "sigma_a";
                                         value = is_share ? share(key, value) : index(key, value);
                                       }});
  }

  // Rejects surfaces that reflect more than they receive. Textures are clamped when they are evaluated.
  void check_sum(const ColorParameter& diffuse, const ColorParameter& specular) const {
    if (diffuse.texture >= 0 || specular.texture >= 0) return;
    const float sum = max_component(diffuse.value + specular.value);
    constexpr float kRounding = 1e-6f;
    if (sum > 1 + kRounding)
      field_.mistake(
          fmt::format("{} and {} add up to {:.6g}, and nothing reflects more than 1; lower one of them",
                      name_with_default("diffuse", diffuse), name_with_default("specular", specular), sum));
  }

 private:
  static const ScalarRules& rules_of(std::string_view key) {
    if (key.ends_with("ior")) return kIor;
    return key.ends_with("depth") || key.ends_with("thickness") || key.ends_with("melanin") ? kLength
                                                                                            : kRoughness;
  }

  // The key, with its default if the file does not set it: 'specular'.
  std::string name_with_default(std::string_view key, const ColorParameter& value) const {
    return find(key) ? in_quotes(key) : fmt::format("{} ({} unless given)", in_quotes(key), value.value.r);
  }

  Field field_;
  ObjectReader object_;
  const std::vector<TextureEntry>& textures_;
  ParameterTracks& tracks_;
};

MicrofacetKind read_microfacets(const ParameterReader& read) {
  MicrofacetKind kind;
  kind.distribution = read.choice("distribution", kind.distribution, scene_keys::kDistributions);
  kind.masking = read.choice("masking", kind.masking, scene_keys::kSmithMaskings);
  return kind;
}

Glass read_glass(const ParameterReader& read) {
  Glass glass;
  glass.ior = read.scalar("ior", glass.ior, kIor);
  glass.reflectance = read.share("reflectance", glass.reflectance);
  glass.transmittance = read.share("transmittance", glass.transmittance);
  glass.fresnel = read.choice("fresnel", glass.fresnel, scene_keys::kDielectricFresnels);
  glass.roughness = read.scalar("roughness", glass.roughness, kRoughness);
  glass.microfacets = read_microfacets(read);
  return glass;
}

Phong read_phong(const ParameterReader& read) {
  Phong phong;
  phong.diffuse = read.share("diffuse", phong.diffuse);
  phong.specular = read.share("specular", phong.specular);
  phong.exponent = read.scalar("exponent", phong.exponent, kExponent);
  phong.lobe = read.choice("lobe", phong.lobe, scene_keys::kPhongLobes);
  read.check_sum(phong.diffuse, phong.specular);
  return phong;
}

CookTorrance read_cook_torrance(const ParameterReader& read) {
  CookTorrance model;
  model.diffuse = read.share("diffuse", model.diffuse);
  model.specular = read.share("specular", model.specular);
  model.f0 = read.share("f0", model.f0);
  if (const auto metal = read.find("conductor")) {
    model.conductor = static_cast<Conductor>(read_choice(*metal, scene_keys::kConductors));
    if (read.find("f0")) metal->mistake("a conductor has its own reflectance; leave 'f0' out, or this");
  }
  model.roughness = read.scalar("roughness", model.roughness, kRoughness);
  model.masking = read.choice("masking", model.masking, scene_keys::kMaskings);
  read.check_sum(model.diffuse, model.specular);
  return model;
}

Principled read_principled(const ParameterReader& read) {
  Principled model;
  read.all(model);
  model.geometry_thin_walled = read.truth("geometry_thin_walled", model.geometry_thin_walled);
  return model;
}

Plastic read_plastic(const ParameterReader& read) {
  Plastic model;
  read.all(model);
  model.nonlinear = read.truth("nonlinear", model.nonlinear);
  model.microfacets = read_microfacets(read);
  model.compensated = read.truth("compensated", model.compensated);
  return model;
}

ConductorMaterial read_conductor(const ParameterReader& read) {
  ConductorMaterial model;
  read.all(model);
  model.microfacets = read_microfacets(read);
  if (const auto metal = read.find("metal")) {
    const auto index = complex_index(static_cast<Conductor>(read_choice(*metal, scene_keys::kConductors)));
    model.eta = {index.eta, -1};
    model.k = {index.k, -1};
    if (read.find("eta") || read.find("k"))
      metal->mistake("a metal has its own 'eta' and 'k'; leave them out");
  }
  return model;
}

// What is given tells the pigment.
Hair read_hair(const ParameterReader& read) {
  Hair model;
  read.all(model);
  const auto reflectance = read.find("reflectance"), sigma_a = read.find("sigma_a");
  const bool has_melanin = read.find("eumelanin") || read.find("pheomelanin");
  if (sigma_a) model.pigment = HairPigment::kAbsorption;
  if (reflectance) model.pigment = HairPigment::kReflectance;
  if ((reflectance ? 1 : 0) + (sigma_a ? 1 : 0) + (has_melanin ? 1 : 0) > 1)
    (reflectance ? reflectance : sigma_a)
        ->mistake("hair has one of 'reflectance', 'sigma_a' and melanin; leave the others out");
  if (const auto tilt = read.find("tilt_degrees")) model.tilt_degrees = read_float(*tilt, kHairTilt);
  return model;
}

template <typename Model>
Model read_all(const ParameterReader& read) {
  Model model;
  read.all(model);
  return model;
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

Blend read_blend(const ParameterReader& read, const std::vector<MaterialEntry>& above) {
  auto model = read_all<Blend>(read);
  const auto parts = read.find("materials");
  if (!parts) return model;
  const auto* names = parts->value().get_if<JsonValue::Array>();
  if (names == nullptr || names->size() != 2) {
    parts->must_be("a list of 2 names of materials");
    return model;
  }
  model.first = read_part(parts->element(0), above);
  model.second = read_part(parts->element(1), above);
  return model;
}

// `type` is an index into kMaterialTypes.
MaterialModel read_model(const ParameterReader& read, std::size_t type,
                         const std::vector<MaterialEntry>& above) {
  if (type == 0) return Lambert{read.share("albedo", Lambert{}.albedo)};
  if (type == 1) return Mirror{read.share("reflectance", Mirror{}.reflectance)};
  if (type == 2) return read_glass(read);
  if (type == 3) return read_phong(read);
  if (type == 4) return read_cook_torrance(read);
  if (type == 5) return read_principled(read);
  if (type == 6) return read_plastic(read);
  if (type == 7) return read_conductor(read);
  if (type == 8) return read_all<DiffuseTransmission>(read);
  if (type == 9) return read_all<ThinDielectric>(read);
  if (type == 10) return read_blend(read, above);
  if (type == 12) return read_hair(read);
  return Null{};
}

// Keyframes are added to `tracks`.
Material read_material(const Field& field, const std::string& name, const std::vector<TextureEntry>& textures,
                       const std::vector<MediumDescription>& media, const std::vector<MaterialEntry>& above,
                       ParameterTracks& tracks) {
  static constexpr std::array kRules{scene_keys::kLambert,
                                     scene_keys::kMirror,
                                     scene_keys::kGlass,
                                     scene_keys::kPhong,
                                     scene_keys::kCookTorrance,
                                     scene_keys::kPrincipled,
                                     scene_keys::kPlastic,
                                     scene_keys::kConductor,
                                     scene_keys::kDiffuseTransmission,
                                     scene_keys::kThinDielectric,
                                     scene_keys::kBlend,
                                     scene_keys::kNull,
                                     scene_keys::kHair};
  const auto type = read_type(field, kMaterialTypes, "material");
  if (!type) return {name, Lambert{}};
  const ParameterReader read(field, kRules[*type], textures, tracks);
  Material material{name, read_model(read, *type, above)};
  material.emission =
      read.color("emission", material.emission, bounds::kNotNegative, scene_keys::kTexturedEmission);
  if (const auto sides = find_member_field(field, "emission_sides"))
    material.two_sided_emission = read_choice(*sides, Words(kSides)) == 0;
  const bool microfacets = std::holds_alternative<CookTorrance>(material.model);
  if (const auto sampling = find_member_field(field, "sampling"))
    material.sampling =
        static_cast<Sampling>(read_choice(*sampling, microfacets ? Words(kMicrofacetSamplings) : kSamplings));
  material.normal_map = read.map("normal_map", kNormalMapRules, &NormalMap::strength);
  material.bump = read.map("bump", kBumpRules, &BumpMap::height);
  material.opacity = read.scalar("opacity", material.opacity, kOpacity);
  if (const auto sides = find_member_field(field, "sides"))
    material.two_sided = read_choice(*sides, Words(kSides)) == 0;
  if (const auto medium = find_member_field(field, "interior_medium"))
    material.media.interior = read_medium_name(*medium, media);
  if (const auto medium = find_member_field(field, "exterior_medium"))
    material.media.exterior = read_medium_name(*medium, media);
  return material;
}

// The textures that are used as colours, and those used as numbers.
struct TextureUses {
  std::set<int> colors, numbers;

  void operator()(std::string_view, const ColorParameter& parameter) { colors.insert(parameter.texture); }
  void operator()(std::string_view, const ScalarParameter& parameter) { numbers.insert(parameter.texture); }
};

TextureUses uses_of(const SceneFile& scene) {
  TextureUses uses;
  if (scene.environment) uses("radiance", scene.environment->radiance);
  for (const auto& entry : scene.materials) {
    visit_parameters(entry.material.model, std::ref(uses));
    uses("emission", entry.material.emission);
    uses.numbers.insert(entry.material.normal_map.texture);
    uses.numbers.insert(entry.material.bump.texture);
    uses("opacity", entry.material.opacity);
  }
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
    if (const auto space = object.find("color_space"); space && texture.channel == TextureChannel::kAlpha)
      space->mistake("alpha has no colour space; leave this out");
    texture.wrap = read_or(object, "wrap", texture.wrap, read_choice, Words(kWraps));
    texture.scale = read_or(object, "scale", texture.scale, read_vec2, bounds::kAny);
    texture.offset = read_or(object, "offset", texture.offset, read_vec2, bounds::kAny);
    if (const auto wrap = object.find("wrap_v"))
      texture.wrap_v = static_cast<Wrap>(read_choice(*wrap, Words(kWraps)));
    texture.shear = read_or(object, "shear", texture.shear, read_vec2, bounds::kAny);
    textures.push_back(std::move(texture));
  }
  return textures;
}

std::vector<MaterialEntry> read_materials(const Field& field, const std::vector<TextureEntry>& textures,
                                          const std::vector<MediumDescription>& media) {
  std::vector<MaterialEntry> materials;
  for (const auto& [name, entry] : read_named(field)) {
    ParameterTracks tracks;
    Material material = read_material(entry, name, textures, media, materials, tracks);
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
