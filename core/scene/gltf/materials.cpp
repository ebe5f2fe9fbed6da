// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/materials.hpp"
#include "core/scene/gltf/ignored_attributes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/scene/absorbing_media.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core::gltf {
namespace {

enum class AlphaMode { kOpaque, kMask, kBlend };

AlphaMode alpha_mode(const Value& material) {
  const std::string mode = material.text("alphaMode");
  if (mode == "MASK") return AlphaMode::kMask;
  return mode == "BLEND" ? AlphaMode::kBlend : AlphaMode::kOpaque;
}

// The base colour's parameters stand at one of two places.
struct BaseKeys {
  Value place;
  const char* factor;
  const char* texture;
};
BaseKeys base_keys(const Value& material) {
  const Value glossiness = material.extension("KHR_materials_pbrSpecularGlossiness");
  if (glossiness.exists()) return {glossiness, "diffuseFactor", "diffuseTexture"};
  return {material["pbrMetallicRoughness"], "baseColorFactor", "baseColorTexture"};
}

}  // namespace

float Materials::turns_of(float radians) {
  const double turns = double{radians} / (2 * double{kPi});
  return static_cast<float>(turns - std::round(turns));
}

Materials::Use Materials::use(const Value& index) {
  const Value material =
      index.exists() ? document_.element_or_none("materials", index, "the default material replaces it")
                     : Value();
  const auto known = converted_.find(material.path());
  if (known != converted_.end()) return known->second;
  return converted_.emplace(material.path(), convert(material)).first->second;
}

std::uint32_t Materials::tinted(const Use& use, const VertexTint& tint) {
  if (tint == VertexTint()) return use.material;
  const auto& [color, alpha] = tint;
  const std::string key = fmt::format("{} {} {} {} {}", use.value.path(), color.r, color.g, color.b, alpha);
  const auto known = tinted_.find(key);
  if (known != tinted_.end()) return known->second;
  Material changed = document_.builder().material(use.material);
  textures_.continue_material(use.coordinates);
  changed.opacity = opacity(use.value, alpha);
  if (use.unlit) changed.emission.value = changed.emission.value * color;
  if (auto* model = std::get_if<Principled>(&changed.model))
    model->transmission_color.value = model->transmission_color.value * color;
  return tinted_.emplace(key, document_.builder().add_material(std::move(changed))).first->second;
}

Materials::Use Materials::convert(const Value& material) {
  Use use;
  const BaseKeys base = base_keys(material);
  textures_.begin_material(base.place[base.texture]);
  const std::string mode = material.text("alphaMode");
  if (!mode.empty() && mode != "OPAQUE" && mode != "MASK" && mode != "BLEND")
    document_.warn(material["alphaMode"], "alpha mode",
                   fmt::format("there is no alpha mode {}; the material is opaque", in_quotes(mode)));
  use.value = material;
  use.coordinate_names = coordinate_names(material);
  use.transparent = alpha_mode(material) != AlphaMode::kOpaque;
  use.unlit = material.extension("KHR_materials_unlit").exists();
  use.material = add(material, use.unlit ? unlit(material) : surface(material));
  const auto* model = std::get_if<Principled>(&document_.builder().material(use.material).model);
  use.transmits = model != nullptr && model->transmission_weight.value > 0;
  use.coordinates = textures_.coordinates();
  return use;
}

std::uint32_t Materials::add(const Value& material, Material surface) {
  surface.shading_normals = ShadingNormals::kPlain;
  surface.name = printable(material.text("name"));
  if (surface.name.empty()) surface.name = material.exists() ? material.path() : "default";
  return document_.builder().add_material(std::move(surface));
}

Material Materials::surface(const Value& material) {
  Material surface;
  surface.model = principled(material);
  surface.media.interior = medium_inside(material, std::get<Principled>(surface.model));
  surface.opacity = opacity(material);
  surface.normal_map = normal_map(material["normalTexture"]);
  add_emission(material, surface);
  if (material["occlusionTexture"].exists())
    document_.warn(material["occlusionTexture"], "occlusion",
                   "baked occlusion is ignored: light transport computes it");
  return surface;
}

// What attenuates light in a volume; the base colour tints the light where it crosses the boundary.
int Materials::medium_inside(const Value& material, const Principled& model) {
  const Value volume = material.extension("KHR_materials_volume");
  const float distance = volume.number_or("attenuationDistance", 0);
  if (model.geometry_thin_walled || !(model.transmission_weight.value > 0) || !(distance > 0))
    return kNoMedium;
  const Rgb color = clamped(volume, volume.color_or("attenuationColor", Rgb::gray(1)));
  if (color == Rgb::gray(1)) return kNoMedium;
  std::vector<MediumDescription>& media = document_.builder().scene().media;
  MediumDescription medium;
  medium.name = material.path();
  medium.sigma_a = absorption_of(color, distance);
  media.push_back(std::move(medium));
  return static_cast<int>(media.size()) - 1;
}

Material Materials::unlit(const Value& material) {
  document_.warn(material, "unlit",
                 "an unlit surface is rendered as one that emits its colour, which also lights others");
  Material surface;
  surface.model = Lambert{{Rgb{}}};
  surface.opacity = opacity(material);
  surface.emission = base_color(material);
  return surface;
}

void Materials::add_emission(const Value& material, Material& surface) {
  const Rgb factor = material.color_or("emissiveFactor", Rgb{});
  const float strength =
      material.extension("KHR_materials_emissive_strength").number_or("emissiveStrength", 1);
  const Rgb radiance = factor * strength;
  if (!(std::min({radiance.r, radiance.g, radiance.b}) >= 0) || !is_finite(radiance))
    return document_.warn(material, "emission",
                          "its emission must be finite and not negative; it does not emit");
  if (is_black(radiance)) return;
  surface.emission = {radiance, textures_.color(material["emissiveTexture"])};
  surface.two_sided_emission = material.is_true("doubleSided");
}

ColorParameter Materials::base_color(const Value& material) {
  const auto [place, factor_key, texture_key] = base_keys(material);
  const auto factor = place.numbers(factor_key, 4);
  const Rgb color = factor.empty() ? Rgb::gray(1) : Rgb{factor[0], factor[1], factor[2]};
  return {clamped(place, color), textures_.color(place[texture_key])};
}

ScalarParameter Materials::opacity(const Value& material, float vertex_alpha) {
  const AlphaMode mode = alpha_mode(material);
  if (mode == AlphaMode::kOpaque) return 1;
  const auto [place, factor_key, texture_key] = base_keys(material);
  const auto factor = place.numbers(factor_key, 4);
  const float alpha = vertex_alpha * (factor.empty() ? 1 : within(place, factor_key, factor[3], 0, 1));
  const Value info = place[texture_key];
  if (mode == AlphaMode::kBlend) return {alpha, textures_.data(info, TextureChannel::kAlpha)};
  const float cutoff = std::clamp(material.number_or("alphaCutoff", 0.5f), 0.0f, kMaxPatternValue);
  const int image = textures_.data(info, TextureChannel::kAlpha);
  if (image < 0) return alpha >= cutoff ? 1.0f : 0.0f;
  const StepPattern mask{{Rgb::gray(alpha), image}, cutoff};
  return {1, document_.builder().add_texture(
                 {.image = nullptr, .procedural = ProceduralTexture{.pattern = mask}})};
}

Principled Materials::principled(const Value& material) {
  Principled model;
  model.base_color = base_color(material);
  const Value ior = material.extension("KHR_materials_ior");
  if (const float index = ior.number_or("ior", 1.5f); index > 0) {
    model.specular_ior = within(ior, "ior", index, 1, kMaxIor);
  } else {
    model.specular_ior = kMaxIor;
    document_.warn(ior, "infinite index", fmt::format("an infinite index of refraction becomes {}", kMaxIor));
  }
  const Value glossiness = material.extension("KHR_materials_pbrSpecularGlossiness");
  if (glossiness.exists())
    add_specular_glossiness(glossiness, model);
  else
    add_metalness(material["pbrMetallicRoughness"], model);
  add_transmission(material, model);
  add_diffuse_transmission(material, model);
  add_specular(material.extension("KHR_materials_specular"), model);
  add_anisotropy_direction(material.extension("KHR_materials_anisotropy"), model);
  add_diffuse_roughness(material.extension("KHR_materials_diffuse_roughness"), model);
  add_coat(material, model);
  add_roughness(material, model);
  // The draft takes precedence, even without weight.
  if (const Value fuzz = material.extension("KHR_materials_fuzz"); fuzz.exists())
    add_fuzz(fuzz, model);
  else
    add_sheen(material.extension("KHR_materials_sheen"), model);
  add_iridescence(material.extension("KHR_materials_iridescence"), model);
  return model;
}

void Materials::add_metalness(const Value& place, Principled& model) {
  model.base_metalness =
      parameter(factor(place, "metallicFactor", 1, "metallicRoughnessTexture", TextureChannel::kBlue));
}

void Materials::add_specular(const Value& extension, Principled& model) {
  const bool is_metal = model.base_metalness.texture < 0 && model.base_metalness.value >= 1;
  if (!extension.exists() || is_metal) return;  // metals do not depend on it
  model.specular_weight = share(extension, "specularFactor", 1,
                                textures_.data(extension["specularTexture"], TextureChannel::kAlpha));
  model.specular_color = {specular_color(extension, model),
                          textures_.color(extension["specularColorTexture"])};
  if (model.base_metalness.value > 0)
    document_.warn(extension, "specular of metal", "the specular factor also changes the metallic part");
}

// The brightest channel changes the reflectance of the index, of which the others are shares: OpenPBR's
// colour would tint the reflection and leave the base as dark as below an untinted one.
Rgb Materials::specular_color(const Value& extension, Principled& model) {
  const Rgb color = extension.color_or("specularColorFactor", Rgb::gray(1));
  const float strongest = max_component(color);
  if (!is_finite(color) || std::min({color.r, color.g, color.b}) < 0) return clamped(extension, color);
  if (strongest == 1) return color;
  const bool transmits = model.transmission_weight.value > 0;
  if (transmits && strongest < 1) return color;
  if (transmits && !model.geometry_thin_walled) {
    document_.warn(extension, "strong specular",
                   "a colour above 1 would change the refraction of what transmits; it is clamped");
    return clamped(extension, color);
  }
  const float normal = normal_reflectance(model.specular_ior.value), wanted = normal * strongest;
  model.specular_ior = index_of_reflectance(std::min(wanted, 1.0f), kMaxIor);
  const float reached = normal_reflectance(model.specular_ior.value);
  if (!(reached > 0)) return Rgb::gray(1);
  constexpr float kVisible = 0.01f;
  if (std::min(wanted, 1.0f) > reached + kVisible)
    document_.warn(extension, "strong specular",
                   fmt::format("a dielectric reflects at most {:.2f} at normal incidence", reached));
  const auto share_of = [&](float value) { return std::clamp(normal * value / reached, 0.0f, 1.0f); };
  return {share_of(color.r), share_of(color.g), share_of(color.b)};
}

void Materials::add_transmission(const Value& material, Principled& model) {
  const Value extension = material.extension("KHR_materials_transmission");
  const Value volume = material.extension("KHR_materials_volume");
  if (!(extension.number_or("transmissionFactor", 0) > 0)) return;
  model.transmission_weight = share(extension, "transmissionFactor", 0,
                                    textures_.data(extension["transmissionTexture"], TextureChannel::kRed));
  if (volume["thicknessTexture"].exists())
    document_.warn(volume["thicknessTexture"], "thickness texture",
                   "the thickness of a volume is that of its geometry; the texture is ignored");
  model.geometry_thin_walled = !(volume.number_or("thicknessFactor", 0) > 0);
  model.transmission_color = model.base_color;
  const Value dispersion = material.extension("KHR_materials_dispersion");
  // 20 over the Abbe number.
  const float strength =
      within(dispersion, "dispersion", dispersion.number_or("dispersion", 0), 0, kMaxDispersionScale);
  if (model.geometry_thin_walled && strength > 0)
    document_.warn(dispersion, "dispersion", "only volumes with a thickness have dispersion; it is ignored");
  else
    model.transmission_dispersion = {.scale = strength, .abbe_number = 20};
}

// OpenPBR's subsurface scattering of a sheet, all of it forwards.
void Materials::add_diffuse_transmission(const Value& material, Principled& model) {
  const Value extension = material.extension("KHR_materials_diffuse_transmission");
  const ScalarParameter& clear = model.transmission_weight;
  const bool is_covered = clear.texture < 0 && clear.value >= 1;
  if (!(extension.number_or("diffuseTransmissionFactor", 0) > 0) || is_covered) return;
  if (clear.value > 0 && !model.geometry_thin_walled)
    return document_.warn(extension, "diffuse transmission",
                          "a solid that partly transmits has no diffuse transmission; it is ignored");
  const Value volume = material.extension("KHR_materials_volume");
  if (volume.number_or("thicknessFactor", 0) > 0)
    document_.warn(volume, "diffuse volume",
                   "a volume with diffuse transmission becomes a sheet, which does not absorb");
  model.subsurface_weight =
      share(extension, "diffuseTransmissionFactor", 0,
            textures_.data(extension["diffuseTransmissionTexture"], TextureChannel::kAlpha));
  model.subsurface_color = tint(extension, "diffuseTransmissionColorFactor", Rgb::gray(1),
                                textures_.color(extension["diffuseTransmissionColorTexture"]));
  model.subsurface_scatter_anisotropy = 1;
  model.geometry_thin_walled = true;
}

// Both count from growing u counter-clockwise, towards growing v as v points upwards here.
void Materials::add_anisotropy_direction(const Value& extension, Principled& model) {
  if (!(extension.number_or("anisotropyStrength", 0) > 0)) return;
  model.tangent.map.texture = textures_.data(extension["anisotropyTexture"], TextureChannel::kColor);
  model.tangent.rotation = turns_of(extension.number_or("anisotropyRotation", 0));
}

// The draft of a coat takes precedence, even without weight.
void Materials::add_coat(const Value& material, Principled& model) {
  const Value draft = material.extension("KHR_materials_coat");
  if (draft.exists())
    add_openpbr_coat(material, model);
  else
    add_clearcoat(material, model);
}

Materials::Factor Materials::clearcoat_weight(const Value& extension) const {
  return factor(extension, "clearcoatFactor", 0, "clearcoatTexture", TextureChannel::kRed);
}

Materials::Factor Materials::clearcoat_roughness(const Value& extension) const {
  return factor(extension, "clearcoatRoughnessFactor", 0, "clearcoatRoughnessTexture",
                TextureChannel::kGreen);
}

void Materials::add_clearcoat(const Value& material, Principled& model) {
  const Value extension = material.extension("KHR_materials_clearcoat");
  if (!(extension.number_or("clearcoatFactor", 0) > 0)) return;
  const Factor weight = clearcoat_weight(extension);
  model.coat_weight = parameter(weight);
  model.coat_roughness = parameter(clearcoat_roughness(extension));
  model.coat_ior = 1.5f;
  model.coat_darkening = 0;
  keep_index_below_coat(extension, weight, model);
  set_coat_normal(material, extension["clearcoatNormalTexture"], model);
}

// A coat without a normal map of its own is flat, whatever that of the base.
void Materials::set_coat_normal(const Value& material, const Value& info, Principled& model) {
  model.geometry_coat_normal = normal_map(info);
  if (model.geometry_coat_normal.texture >= 0) return;
  model.geometry_coat_normal = normal_map(material["normalTexture"]);
  model.geometry_coat_normal.strength = model.geometry_coat_normal.texture < 0 ? 1.0f : 0.0f;
}

NormalMap Materials::normal_map(const Value& info) {
  return {textures_.data(info, TextureChannel::kColor), info.number_or("scale", 1)};
}

void Materials::add_sheen(const Value& extension, Principled& model) {
  const Rgb color = clamped(extension, extension.color_or("sheenColorFactor", Rgb{}));
  const float strongest = max_component(color);
  if (!(strongest > 0)) return;
  model.fuzz_weight = strongest;
  model.fuzz_color = {color / strongest, textures_.color(extension["sheenColorTexture"])};
  model.fuzz_roughness = share(extension, "sheenRoughnessFactor", 0,
                               textures_.data(extension["sheenRoughnessTexture"], TextureChannel::kAlpha));
  document_.warn(extension, "sheen", "sheen is approximated by OpenPBR's fuzz");
}

void Materials::add_iridescence(const Value& extension, Principled& model) {
  if (!(extension.number_or("iridescenceFactor", 0) > 0)) return;
  if (model.transmission_weight.value > 0)
    document_.warn(extension, "iridescent transmission",
                   "iridescence does not change what a transmissive surface reflects");
  model.thin_film_weight = share(extension, "iridescenceFactor", 0,
                                 textures_.data(extension["iridescenceTexture"], TextureChannel::kRed));
  model.thin_film_ior =
      within(extension, "iridescenceIor", extension.number_or("iridescenceIor", 1.3f), 1, kMaxIor);
  constexpr float kMicrometres = 1e-3f;  // per nanometre
  constexpr float kThickestNm = 1e6f;
  const auto thickness = [&](std::string_view key, float otherwise) {
    return within(extension, key, extension.number_or(key, otherwise), 0, kThickestNm);
  };
  const float least = thickness("iridescenceThicknessMinimum", 100);
  const float most = thickness("iridescenceThicknessMaximum", 400);
  const float thickest = std::max(least, most);
  const int texture = textures_.converted(
      extension["iridescenceThicknessTexture"], TextureChannel::kGreen,
      fmt::format("film {} {}", least, most),
      [&](float value) { return thickest > 0 ? (least + (most - least) * value) / thickest : 0; });
  model.thin_film_thickness =
      texture < 0 ? ScalarParameter(most * kMicrometres) : ScalarParameter(thickest * kMicrometres, texture);
}

Materials::Factor Materials::factor(const Value& place, std::string_view key, float otherwise,
                                    std::string_view texture_key, TextureChannel channel) const {
  return {within(place, key, place.number_or(key, otherwise), 0, 1), place[texture_key], channel};
}

ScalarParameter Materials::parameter(const Factor& factor) {
  return {factor.value, textures_.data(factor.info, factor.channel)};
}

ScalarParameter Materials::share(const Value& place, std::string_view key, float otherwise,
                                 int texture) const {
  return {within(place, key, place.number_or(key, otherwise), 0, 1), texture};
}

float Materials::within(const Value& place, std::string_view key, float value, float least,
                        float most) const {
  const float kept = std::clamp(value, least, most);
  if (kept != value)
    document_.warn(place[key], "range",
                   fmt::format("must be between {:g} and {:g}; it becomes {:g}", least, most, kept));
  return kept;
}

Rgb Materials::clamped(const Value& place, Rgb color) const {
  const auto clamp = [](float value) { return std::clamp(value, 0.0f, 1.0f); };
  const Rgb kept{clamp(color.r), clamp(color.g), clamp(color.b)};
  if (!(kept == color)) document_.warn(place, "range", "colours must be between 0 and 1; they are clamped");
  return kept;
}

ColorParameter Materials::tint(const Value& place, std::string_view key, Rgb otherwise, int texture) const {
  return {clamped(place[key], place.color_or(key, otherwise)), texture};
}

}  // namespace tessera::core::gltf
