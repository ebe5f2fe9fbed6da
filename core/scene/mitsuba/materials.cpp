// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mitsuba/materials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/suggestion.hpp"
#include "core/scene/mitsuba/refraction.hpp"

namespace tessera::core::mitsuba {
namespace {

constexpr NodeId kNoNode = std::numeric_limits<NodeId>::max();
constexpr float kUnbounded = std::numeric_limits<float>::max();

Surface one_sided(const Plugin& bsdf, MaterialModel model) {
  Surface surface;
  surface.material.name = bsdf.name();
  surface.material.model = std::move(model);
  surface.material.two_sided = false;
  return surface;
}

Surface open(const Plugin& bsdf, MaterialModel model) {
  Surface surface = one_sided(bsdf, std::move(model));
  surface.material.two_sided = true;
  return surface;
}

// The index for which Burley's "specular" is the reflectance at normal incidence, times 0.08.
float index_of_specular(float specular) {
  return 2 / (1 - std::sqrt(0.08f * std::clamp(specular, 0.0f, 1.0f))) - 1;
}

Rgb square_root(Rgb c) {
  const auto root = [](float channel) { return std::sqrt(std::max(channel, 0.0f)); };
  return {root(c.r), root(c.g), root(c.b)};
}

// Of a shape without a BSDF. Lamps are black.
Surface default_surface(bool emits) {
  Surface surface;
  surface.material.model = Lambert{{Rgb::gray(emits ? 0.0f : 0.5f), -1}};
  surface.material.two_sided = false;
  return surface;
}

// Estevez, Lecocq and Lambert (2019) darken surfaces where their normals are tilted.
void ignore_shadowing(const Plugin& bsdf) {
  bsdf.ignore({"flip_invalid_normals"});
  if (bsdf.flag("use_shadowing_function", true))
    bsdf.warn("tilted normals do not darken the surface, as 'use_shadowing_function' does");
}

// A constant limited to [0, 1]; textures are limited where they are looked up.
ScalarParameter in_unit(ScalarParameter parameter) {
  if (parameter.texture < 0) parameter.value = std::clamp(parameter.value, 0.0f, 1.0f);
  return parameter;
}

// White, tinted towards a colour of luminance 1.
Rgb tinted(Rgb color, float tint) {
  const float brightness = luminance(color);
  if (!(brightness > 0)) return Rgb::gray(1);
  const auto mix = [&](float channel) { return std::min(1 + tint * (channel / brightness - 1), 1.0f); };
  return {mix(color.r), mix(color.g), mix(color.b)};
}

}  // namespace

MaterialIndex MaterialConverter::material(const MaterialUse& use) {
  const NodeId bsdf = use.bsdf ? use.bsdf->id() : kNoNode;
  const Site site{bsdf, use.site.layout, use.site.attributes};
  const Use key{site, use.emitter ? use.emitter->id() : kNoNode, use.media.interior, use.media.exterior};
  if (const auto known = materials_.find(key); known != materials_.end()) return known->second;
  Surface made = use.bsdf ? surface(*use.bsdf, use.site) : default_surface(use.emitter.has_value());
  made.material.media = use.media;
  if (use.emitter) set_emission(*use.emitter, use.site, made.material);
  if (made.is_reversed) {
    std::swap(made.material.media.interior, made.material.media.exterior);
    if (use.emitter)
      use.emitter->warn("is on the other side of a dielectric that is less dense than its outside");
  }
  const MaterialIndex index{conversion_.builder.add_material(std::move(made.material)), made.is_reversed};
  materials_.emplace(key, index);
  return index;
}

void MaterialConverter::set_emission(const Plugin& emitter, const TextureSite& site, Material& material) {
  if (emitter.type() != "area") {
    emitter.warn("on a shape is not supported; an area light replaces it");
    material.emission = {Rgb::gray(1), -1};
  } else {
    material.emission = textures_.color(emitter, "radiance", Rgb::gray(1), site, kUnbounded);
  }
  emitter.ignore({"sampling_weight"});
  material.two_sided_emission = false;
}

const Surface& MaterialConverter::surface(const Plugin& bsdf, const TextureSite& site, int depth) {
  const Site key{bsdf.id(), site.layout, site.attributes};
  if (const auto known = surfaces_.find(key); known != surfaces_.end()) return known->second;
  return surfaces_.emplace(key, convert(bsdf, site, depth)).first->second;
}

Surface MaterialConverter::convert(const Plugin& bsdf, const TextureSite& site, int depth) {
  const std::string& type = bsdf.type();
  if (type == "diffuse") return diffuse(bsdf, site);
  if (type == "dielectric" || type == "roughdielectric") return dielectric(bsdf, site, type != "dielectric");
  if (type == "thindielectric") return thin_dielectric(bsdf, site);
  if (type == "conductor" || type == "roughconductor") return conductor(bsdf, site, type != "conductor");
  if (type == "plastic" || type == "roughplastic" || type == "pplastic")
    return plastic(bsdf, site, type != "plastic");
  if (type == "principled" || type == "principledthin") return principled(bsdf, site, type != "principled");
  if (type == "blendbsdf") return blend(bsdf, site, depth);
  if (type == "mask") return mask(bsdf, site, depth);
  if (type == "twosided") return two_sided(bsdf, site, depth);
  if (type == "normalmap") return normal_map(bsdf, site, depth);
  if (type == "bumpmap") return bump_map(bsdf, site, depth);
  if (type == "null") return open(bsdf, Null{});
  if (type == "hair") return hair(bsdf, site);
  return unsupported(bsdf);
}

Surface MaterialConverter::diffuse(const Plugin& bsdf, const TextureSite& site) {
  return one_sided(bsdf, Lambert{textures_.color(bsdf, "reflectance", Rgb::gray(0.5f), site)});
}

Surface MaterialConverter::dielectric(const Plugin& bsdf, const TextureSite& site, bool is_rough) {
  const Boundary boundary = boundary_of(bsdf, "bk7");
  Glass glass;
  glass.ior = boundary.ratio;
  glass.reflectance = textures_.color(bsdf, "specular_reflectance", Rgb::gray(1), site);
  glass.transmittance = textures_.color(bsdf, "specular_transmittance", Rgb::gray(1), site);
  if (is_rough) {
    const Roughness rough = roughness(bsdf, site);
    glass.roughness = rough.roughness;
    glass.microfacets = rough.microfacets;
    if (rough.anisotropy.value != 0) bsdf.warn("the anisotropy is left out");
  }
  Surface result = open(bsdf, glass);
  result.is_reversed = boundary.is_reversed;
  return result;
}

Surface MaterialConverter::thin_dielectric(const Plugin& bsdf, const TextureSite& site) {
  if (conversion_.counts_passing) bsdf.warn("crossings do not count for 'max_depth'");
  ThinDielectric thin;
  thin.ior = boundary_of(bsdf, "bk7").ratio;
  thin.reflectance = textures_.color(bsdf, "specular_reflectance", Rgb::gray(1), site);
  thin.transmittance = textures_.color(bsdf, "specular_transmittance", Rgb::gray(1), site);
  return open(bsdf, thin);
}

Surface MaterialConverter::hair(const Plugin& bsdf, const TextureSite& site) {
  constexpr float kMaxMelanin = 1000, kMaxAbsorption = 100;  // more makes no light visible
  Hair model;
  model.eumelanin = std::clamp(bsdf.real("eumelanin", 1.3f), 0.0f, kMaxMelanin);
  model.pheomelanin = std::clamp(bsdf.real("pheomelanin", 0.2f), 0.0f, kMaxMelanin);
  model.beta_m = std::clamp(bsdf.real("longitudinal_roughness", 0.3f), 0.0f, 1.0f);
  model.beta_n = std::clamp(bsdf.real("azimuthal_roughness", 0.3f), 0.0f, 1.0f);
  model.tilt_degrees = std::clamp(bsdf.real("scale_tilt", 2), -kMaxHairTiltDegrees, kMaxHairTiltDegrees);
  model.ior = boundary_of(bsdf, "amber").ratio;
  const float scale = bsdf.real("scale", 1);
  if (bsdf.has("sigma_a")) {
    model.pigment = HairPigment::kAbsorption;
    model.sigma_a = textures_.color(bsdf, "sigma_a", Rgb{}, site, kUnbounded);
    const Rgb scaled = model.sigma_a.value * std::max(scale, 0.0f);
    const auto limited = [most = kMaxAbsorption](float a) { return std::min(a, most); };
    model.sigma_a.value = {limited(scaled.r), limited(scaled.g), limited(scaled.b)};
  }
  bsdf.ignore({"use_pigmentation"});
  return open(bsdf, model);
}

Surface MaterialConverter::conductor(const Plugin& bsdf, const TextureSite& site, bool is_rough) {
  const ComplexIndex index = metal(bsdf);
  ConductorMaterial conductor;
  conductor.eta = textures_.color(bsdf, "eta", index.eta, site, kUnbounded);
  conductor.k = textures_.color(bsdf, "k", index.k, site, kUnbounded);
  conductor.specular = textures_.color(bsdf, "specular_reflectance", Rgb::gray(1), site);
  if (is_rough) {
    const Roughness rough = roughness(bsdf, site);
    conductor.roughness = rough.roughness;
    conductor.anisotropy = rough.anisotropy;
    conductor.microfacets = rough.microfacets;
  }
  return one_sided(bsdf, conductor);
}

// Without a material, everything is reflected.
ComplexIndex MaterialConverter::metal(const Plugin& bsdf) {
  const ComplexIndex mirror{Rgb{}, Rgb::gray(1)};
  const std::string name = bsdf.text("material").value_or("none");
  if (name == "none") return mirror;
  const auto known = metal_index(name);
  if (!known) bsdf.warn(fmt::format("the metal {} is not known; aluminium replaces it", in_quotes(name)));
  return known.value_or(complex_index(Conductor::kAluminium));
}

Surface MaterialConverter::plastic(const Plugin& bsdf, const TextureSite& site, bool is_rough) {
  Plastic plastic;
  const Boundary boundary = boundary_of(bsdf, "polypropylene");
  plastic.ior = boundary.ratio;
  plastic.diffuse = textures_.color(bsdf, "diffuse_reflectance", Rgb::gray(0.5f), site);
  plastic.specular = textures_.color(bsdf, "specular_reflectance", Rgb::gray(1), site);
  plastic.nonlinear = bsdf.flag("nonlinear", false);
  if (is_rough) {
    const Roughness rough = roughness(bsdf, site);
    plastic.roughness = rough.roughness;
    plastic.microfacets = rough.microfacets;
    plastic.compensated = false;
    if (rough.anisotropy.value != 0) bsdf.warn("the anisotropy is left out");
  }
  return one_sided(bsdf, plastic);
}

// Mitsuba's masking is the product of both directions'.
MicrofacetKind MaterialConverter::microfacets(const Plugin& bsdf) {
  const std::string distribution = bsdf.text("distribution").value_or("beckmann");
  if (distribution == "ggx") return {MicrofacetDistribution::kGgx, SmithMasking::kSeparable};
  if (distribution != "beckmann")
    bsdf.warn(
        fmt::format("the distribution of microfacets is Beckmann's instead of {}", in_quotes(distribution)));
  return {MicrofacetDistribution::kBeckmann, SmithMasking::kSeparable};
}

// Alpha is the square of the roughness. With two alphas it is their quadratic mean, as OpenPBR defines the
// anisotropy (Academy Software Foundation 2024, section 3.4).
MaterialConverter::Roughness MaterialConverter::roughness(const Plugin& bsdf, const TextureSite& site) {
  bsdf.ignore({"sample_visible"});
  const MicrofacetKind kind = microfacets(bsdf);
  if (!bsdf.has("alpha_u") && !bsdf.has("alpha_v"))
    return {in_unit(textures_.scalar(bsdf, "alpha", 0.1f, site, TexelMap::kSquareRoot)), 0, kind};
  const ScalarParameter of_u = textures_.scalar(bsdf, "alpha_u", 0.1f, site);
  const ScalarParameter of_v = textures_.scalar(bsdf, "alpha_v", 0.1f, site);
  if (of_u.texture >= 0 || of_v.texture >= 0) {
    bsdf.warn("'alpha_u' is used for both directions, because the alphas have textures");
    return {in_unit(textures_.scalar(bsdf, "alpha_u", 0.1f, site, TexelMap::kSquareRoot)), 0, kind};
  }
  const float u = std::max(of_u.value, 0.0f), v = std::max(of_v.value, 0.0f);
  if (u < v || u == 0) {
    if (u != v) bsdf.warn("the anisotropy is left out, because 'alpha_v' is larger than 'alpha_u'");
    return {std::min(std::sqrt(std::sqrt(u * v)), 1.0f), 0, kind};
  }
  return {std::min(std::sqrt(std::sqrt((u * u + v * v) / 2)), 1.0f), 1 - v / u, kind};
}

// Burley's model (2012, 2015) in the terms of OpenPBR 1.1, which also layers energy: diffuse reflection under
// a dielectric is darker.
Surface MaterialConverter::principled(const Plugin& bsdf, const TextureSite& site, bool is_thin) {
  bsdf.warn("is approximated by OpenPBR's model, which has other diffuse, sheen and clearcoat lobes");
  bsdf.ignore({"main_specular_sampling_rate", "clearcoat_sampling_rate", "diffuse_reflectance_sampling_rate",
               "spec_reflect_sampling_rate", "spec_trans_sampling_rate", "diffuse_trans_sampling_rate"});
  Principled model;
  model.base_color = textures_.color(bsdf, "base_color", Rgb::gray(0.5f), site);
  model.base_metalness = in_unit(textures_.scalar(bsdf, "metallic", 0, site));
  model.specular_roughness = in_unit(textures_.scalar(bsdf, "roughness", 0.5f, site));
  model.specular_roughness_anisotropy = in_unit(textures_.scalar(bsdf, "anisotropic", 0, site));
  model.specular_roughness_anisotropy.value *= 0.9f;
  model.specular_ior =
      std::clamp(bsdf.real("eta", index_of_specular(bsdf.real("specular", 0.5f))), 1.0f, kMaxIor);
  const float tint = textures_.scalar(bsdf, "spec_tint", 0, site).value;
  model.specular_color.value = tinted(model.base_color.value, tint);
  model.transmission_weight = in_unit(textures_.scalar(bsdf, "spec_trans", 0, site));
  model.transmission_color = model.base_color;
  model.transmission_color.value = square_root(model.base_color.value);
  model.coat_weight = in_unit(textures_.scalar(bsdf, "clearcoat", 0, site));
  model.coat_weight.value *= 0.25f;
  const float gloss = std::clamp(textures_.scalar(bsdf, "clearcoat_gloss", 0, site).value, 0.0f, 1.0f);
  model.coat_roughness = std::sqrt(0.1f + (0.001f - 0.1f) * gloss);
  model.coat_ior = 1.5f;
  model.coat_darkening = 0;
  model.fuzz_weight = in_unit(textures_.scalar(bsdf, "sheen", 0, site));
  model.fuzz_weight.value *= 0.1f;  // about as bright at grazing angles
  model.fuzz_color.value =
      tinted(model.base_color.value, textures_.scalar(bsdf, "sheen_tint", 0, site).value);
  model.geometry_thin_walled = is_thin;
  const bool transmits = is_thin || model.transmission_weight.value > 0;
  return transmits ? open(bsdf, model) : one_sided(bsdf, model);
}

Surface MaterialConverter::blend(const Plugin& bsdf, const TextureSite& site, int depth) {
  const std::vector<Plugin> parts = bsdf.children(Kind::kBsdf);
  const ScalarParameter weight = textures_.scalar(bsdf, "weight", 0.5f, site);
  if (parts.size() != 2 || depth >= kMaxBlendDepth) {
    bsdf.warn(parts.size() == 2 ? "blends are nested too deeply; the first BSDF replaces this one"
                                : "must have two BSDFs; the first one replaces it");
    return inner(bsdf, site, depth + 1);
  }
  Blend model;
  model.first = part(parts[0], site, depth + 1);
  model.second = part(parts[1], site, depth + 1);
  model.weight = in_unit(weight);
  Surface result = one_sided(bsdf, model);
  for (const std::uint32_t index : {model.first, model.second})
    if (conversion_.builder.material(index).two_sided) result.material.two_sided = true;
  return result;
}

std::uint32_t MaterialConverter::part(const Plugin& bsdf, const TextureSite& site, int depth) {
  const Site key{bsdf.id(), site.layout, site.attributes};
  if (const auto known = parts_.find(key); known != parts_.end()) return known->second;
  const Surface& made = surface(bsdf, site, depth);
  if (made.is_reversed) bsdf.warn("its inside and outside are exchanged, because it is part of a blend");
  return parts_[key] = conversion_.builder.add_material(made.material);
}

Surface MaterialConverter::mask(const Plugin& bsdf, const TextureSite& site, int depth) {
  Surface result = inner(bsdf, site, depth);
  const ScalarParameter opacity = textures_.scalar(bsdf, "opacity", 0.5f, site);
  const ScalarParameter inside = result.material.opacity;
  if (inside.texture >= 0 || inside.value < 1) bsdf.warn("the opacity inside of another one is left out");
  result.material.opacity = in_unit(opacity);
  return result;
}

Surface MaterialConverter::two_sided(const Plugin& bsdf, const TextureSite& site, int depth) {
  Surface result = inner(bsdf, site, depth);
  if (bsdf.children(Kind::kBsdf).size() > 1)
    bsdf.warn("has the first BSDF on both sides; a second one for the back is left out");
  result.material.two_sided = true;
  return result;
}

Surface MaterialConverter::normal_map(const Plugin& bsdf, const TextureSite& site, int depth) {
  Surface result = inner(bsdf, site, depth);
  ignore_shadowing(bsdf);
  const auto map = bsdf.child("normalmap");
  if (!map) {
    bsdf.warn("lacks the texture 'normalmap'; it is left out");
  } else {
    if (result.material.normal_map.texture >= 0) bsdf.warn("replaces the normal map inside of it");
    result.material.normal_map = {textures_.normal_map(*map, site), 1};
  }
  return result;
}

Surface MaterialConverter::bump_map(const Plugin& bsdf, const TextureSite& site, int depth) {
  Surface result = inner(bsdf, site, depth);
  ignore_shadowing(bsdf);
  const auto map = bsdf.first_child(Kind::kTexture);
  const float scale = bsdf.real("scale", 1);
  if (!map) {
    bsdf.warn("lacks a texture; it is left out");
  } else {
    if (result.material.bump.texture >= 0) bsdf.warn("replaces the bump map inside of it");
    result.material.bump = {textures_.height_map(*map, site), scale};
  }
  return result;
}

Surface MaterialConverter::inner(const Plugin& bsdf, const TextureSite& site, int depth) {
  if (const auto found = bsdf.first_child(Kind::kBsdf)) {
    Surface result = surface(*found, site, depth);
    if (!bsdf.name().empty()) result.material.name = bsdf.name();
    return result;
  }
  bsdf.warn("lacks a BSDF inside of it; a gray diffuse one replaces it");
  return one_sided(bsdf, Lambert{});
}

Surface MaterialConverter::unsupported(const Plugin& bsdf) {
  bsdf.warn("is not supported; a gray diffuse BSDF replaces it");
  bsdf.ignore_all();
  return one_sided(bsdf, Lambert{});
}

}  // namespace tessera::core::mitsuba
