// SPDX-License-Identifier: Apache-2.0
// Metals, with and without a coat.
#include <algorithm>
#include <cmath>

#include "core/materials/fresnel.hpp"
#include "core/scene/pbrt/materials.hpp"

namespace tessera::core::pbrt {
namespace {

// The imaginary index with which a metal of real index 1 reflects `reflectance` at normal incidence.
float index_for_reflectance(float reflectance) {
  const float r = std::clamp(reflectance, 0.0f, 0.9999f);
  return 2 * std::sqrt(r) / std::sqrt(1 - r);
}

}  // namespace

Result<ColorParameter> Materials::mapped(const TexturePtr& texture,
                                         const std::function<float(float)>& function, float limit,
                                         const Place& place) {
  const TexturePtr values = make_texture(ChannelNode{texture, function});
  if (!values) return report_.error(place, "a texture of the reflectance refers to too many others");
  return baker_.color(values, limit, place);
}

ComplexIndex Materials::index_of_metal(const Parameters& p, const std::string& prefix) {
  for (const char* part : {"eta", "k"})
    if (const Parameter* given = p.find(prefix + part); given != nullptr && given->type == "texture")
      report_.warn(p.place_of(given), "textured indices of metals are not supported; copper is used");
  return colors_.metal(p, prefix + "eta", prefix + "k");
}

Result<ConductorMaterial> Materials::metal_of(const TexturePtr& reflectance, const Place& place) {
  constexpr float kMaxIndex = 1000;
  ConductorMaterial metal;
  // A metal that reflects everything, tinted, if nothing else is possible.
  const bool is_tint = reflectance->has_patterns;
  if (is_tint)
    report_.warn(place, "a metal whose reflectance is a pattern reflects no more at grazing angles");
  auto values = is_tint ? baker_.color(reflectance, 1, place)
                        : mapped(reflectance, index_for_reflectance, kMaxIndex, place);
  if (!values) return fail(values.error());
  (is_tint ? metal.specular : metal.k) = *values;
  if (!is_tint) metal.eta = {Rgb::gray(1), -1};
  return metal;
}

Materials::Model Materials::conductor(const Parameters& p) {
  ConductorMaterial metal;
  if (const TexturePtr reflectance = textures_.color(p, "reflectance", SpectrumRole::kAlbedo)) {
    auto made = metal_of(reflectance, p.place_of(p.find("reflectance")));
    if (!made) return fail(made.error());
    metal = *made;
  } else {
    const ComplexIndex index = index_of_metal(p, "");
    metal.eta = {index.eta, -1};
    metal.k = {index.k, -1};
  }
  auto rough = roughness(p, "", 0, true);
  if (!rough) return fail(rough.error());
  metal.roughness = rough->value;
  metal.anisotropy = rough->anisotropy;
  metal.tangent = rough->tangent;
  return metal;
}

Result<ColorParameter> Materials::color_under_coat(const Parameters& p, float coat_index) {
  const TexturePtr reflectance = textures_.color(p, "reflectance", SpectrumRole::kAlbedo);
  if (!reflectance) {
    const ComplexIndex metal = index_of_metal(p, "conductor.");
    return ColorParameter{fresnel_conductor(1.0f, metal.eta / coat_index, metal.k / coat_index), -1};
  }
  const Place place = p.place_of(p.find("reflectance"));
  if (reflectance->has_patterns) {
    report_.warn(
        place, "a metal under a coat whose reflectance is a pattern reflects what it does without the coat");
    return baker_.color(reflectance, 1, place);
  }
  const auto seen_from_coat = [coat_index](float r) {
    return conductor_reflectance(1.0f, 1 / coat_index, index_for_reflectance(r) / coat_index);
  };
  return mapped(reflectance, seen_from_coat, 1, place);
}

Materials::Model Materials::coated_conductor(const Parameters& p) {
  // Parameters of pbrt's own random walk.
  for (const char* known : {"maxdepth", "nsamples"}) p.find(known);
  for (const char* ignored : {"thickness", "g", "albedo"})
    if (p.has(ignored)) p.remark(ignored, "has no effect, because nothing scatters between the layers");
  report_.warn(p.place(),
               "the material 'coatedconductor' is approximated by a metal under the coat of 'principled'");
  const float index = index_of_refraction(p, "interface.eta", 1.5f);
  auto color = color_under_coat(p, index);
  if (!color) return fail(color.error());
  auto base = roughness(p, "conductor.", 0, true), coat = roughness(p, "interface.", 0, true);
  for (const auto* read : {&base, &coat})
    if (!*read) return fail(read->error());
  Principled surface;
  surface.base_metalness = 1;
  surface.base_color = *color;
  surface.specular_roughness = base->value;
  surface.specular_roughness_anisotropy = base->anisotropy;
  surface.tangent = base->tangent;
  surface.coat_weight = 1;
  surface.coat_ior = index;
  surface.coat_roughness = coat->value;
  surface.coat_roughness_anisotropy = coat->anisotropy;
  surface.coat_tangent = coat->tangent;
  return surface;
}

}  // namespace tessera::core::pbrt
