// SPDX-License-Identifier: Apache-2.0
// The roughness of a base or a coat, with its anisotropy, and what a coat does to the base below it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/materials/limits.hpp"
#include "core/scene/gltf/materials.hpp"

namespace tessera::core::gltf {
namespace {

struct Anisotropic {
  float ratio = 0, roughness = 0;
};

// glTF gives the roughness along the direction as mix(alpha, 1, strength^2), and alpha across it; OpenPBR
// 1.1 (section "Microfacet model") the ratio 1 - anisotropy of both, at a mean square that stays.
Anisotropic anisotropic(float alpha, float strength) {
  constexpr float kMinAcross = 1e-3f;
  const float across = std::max(alpha, kMinAcross);
  const float along = across + (1 - across) * strength * strength, ratio = across / along;
  return {1 - ratio, std::min(std::sqrt(along / std::sqrt(2 / (1 + ratio * ratio))), 1.0f)};
}

struct BlurringCoat {
  float weight = 0, roughness = 0;

  // OpenPBR 1.1, section "Coat": the roughness of a base as seen through the coat.
  float blurred(float base) const {
    const float base2 = base * base, coat2 = roughness * roughness;
    const float below = std::sqrt(std::sqrt(std::min(1.0f, base2 * base2 + 2 * coat2 * coat2)));
    return base + (below - base) * weight;
  }
  // The inverse: the base that is seen with the roughness `seen`, or 0 if all are rougher.
  float base_seen_as(float seen) const {
    if (!(weight > 0 && roughness > 0)) return seen;
    float low = 0, high = seen;
    for (int i = 0; i < 16; ++i) {
      const float middle = (low + high) / 2;
      (blurred(middle) < seen ? low : high) = middle;
    }
    return high;
  }
};

}  // namespace

std::string Materials::LayerRoughness::name() const {
  return fmt::format("{} {} {} {} {}", roughness.value, is_glossiness, strength.value, coat_weight.value,
                     coat_roughness.value);
}

Materials::Roughness Materials::roughness_of(const Value& place, const LayerRoughness& layer) {
  if (!layer.is_glossiness && !(layer.strength.value > 0) && !layer.is_blurred())
    return {parameter(layer.roughness)};
  bool is_too_rough = false;
  const auto at = [&](const std::vector<Rgb>& texels) {
    const float value = layer.roughness.value * texels[0].r;
    const float rough = layer.is_glossiness ? 1 - value : value;
    const float strength = layer.strength.value * texels[1].r;
    Anisotropic result{0, rough};
    if (layer.strength.value > 0) result = anisotropic(rough * rough, strength);
    const BlurringCoat coat{layer.coat_weight.value * texels[2].r, layer.coat_roughness.value * texels[3].r};
    constexpr float kVisible = 0.01f;
    is_too_rough |= coat.blurred(0) > result.roughness + kVisible;
    result.roughness = coat.base_seen_as(result.roughness);
    return result;
  };
  std::vector<Textures::Input> inputs{layer.roughness.input(), layer.strength.input()};
  for (const Factor& factor : {layer.coat_weight, layer.coat_roughness})
    inputs.push_back(layer.is_blurred() ? factor.input() : Textures::Input{});
  const auto made = [&](const char* kind, float Anisotropic::*member) {
    const int texture =
        textures_.combined(inputs, ColorSpace::kLinear, fmt::format("{} {}", kind, layer.name()),
                           [&](const std::vector<Rgb>& texels) { return Rgb::gray(at(texels).*member); });
    const std::vector<Rgb> white(inputs.size(), Rgb::gray(1));
    return texture < 0 ? ScalarParameter(at(white).*member) : ScalarParameter(1, texture);
  };
  const Roughness result{
      made("roughness", &Anisotropic::roughness),
      layer.strength.value > 0 ? made("anisotropy", &Anisotropic::ratio) : ScalarParameter(0)};
  if (is_too_rough)
    document_.warn(place, "rough coat", "a coat so much rougher than the base also roughens the base");
  return result;
}

void Materials::add_roughness(const Value& material, Principled& model) {
  const Value glossiness = material.extension("KHR_materials_pbrSpecularGlossiness");
  const Value anisotropy = material.extension("KHR_materials_anisotropy");
  const Value clearcoat = material.extension("KHR_materials_clearcoat");
  LayerRoughness base;
  base.is_glossiness = glossiness.exists();
  base.roughness = base.is_glossiness ? factor(glossiness, "glossinessFactor", 1, "specularGlossinessTexture",
                                               TextureChannel::kAlpha)
                                      : factor(material["pbrMetallicRoughness"], "roughnessFactor", 1,
                                               "metallicRoughnessTexture", TextureChannel::kGreen);
  base.strength = factor(anisotropy, "anisotropyStrength", 0, "anisotropyTexture", TextureChannel::kBlue);
  if (!material.extension("KHR_materials_coat").exists()) {
    base.coat_weight = clearcoat_weight(clearcoat);
    base.coat_roughness = clearcoat_roughness(clearcoat);
  }
  // No coat blurs what leaves a solid from inside.
  if (base.is_blurred() && model.transmission_weight.value > 0) {
    document_.warn(clearcoat, "rough coat", "a rough coat also roughens the transmissive base below it");
    base.coat_weight = {};
  }
  const Roughness made = roughness_of(clearcoat.exists() ? clearcoat : material, base);
  model.specular_roughness = made.roughness;
  model.specular_roughness_anisotropy = made.anisotropy;
}

// The reflectance of glTF's base is that in air; OpenPBR's depends on the coat above it (OpenPBR 1.1, section
// "Coat"), of index mix(1, coat_ior, coat_weight).
void Materials::keep_index_below_coat(const Value& extension, const Factor& coat_weight, Principled& model) {
  const ScalarParameter& clear = model.transmission_weight;
  if (clear.value > 0) {
    if (clear.value < 1 || clear.texture >= 0)
      document_.warn(extension, "coated index",
                     "what a partly transmissive base does not transmit reflects less below its coat");
    return;
  }
  const float in_air = model.specular_ior.value, coat = model.coat_ior.value;
  const auto raised = [&](float weight) { return std::min(in_air * (1 + (coat - 1) * weight), kMaxIor); };
  const float highest = raised(coat_weight.value);
  const int texture = textures_.converted(
      coat_weight.info, coat_weight.channel, fmt::format("index {} {} {}", in_air, coat, coat_weight.value),
      [&](float texel) { return raised(coat_weight.value * texel) / highest; });
  model.specular_ior = {highest, texture};
  if (highest == kMaxIor)
    document_.warn(extension, "coated index", "a base of so high an index reflects less below its coat");
}

}  // namespace tessera::core::gltf
