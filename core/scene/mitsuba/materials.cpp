// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mitsuba/materials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/base/suggestion.hpp"
#include "core/materials/directional_albedo.hpp"
#include "core/scene/mitsuba/refraction.hpp"
#include "core/scene/tables/words.hpp"

namespace tessera::core::mitsuba {
namespace {

constexpr NodeId kNoNode = std::numeric_limits<NodeId>::max();
constexpr float kUnbounded = std::numeric_limits<float>::max();

// The index for which Burley's "specular" is the reflectance at normal incidence, times 0.08.
float index_of_specular(float specular) {
  return 2 / (1 - std::sqrt(0.08f * std::clamp(specular, 0.0f, 1.0f))) - 1;
}

// Of a shape without a BSDF. Lamps are black.
Surface default_surface(bool emits) {
  Surface surface;
  surface.material.model = Lambert{{Rgb::gray(emits ? 0.0f : 0.5f), -1}};
  surface.material.two_sided = false;
  surface.material.shading_normals = ShadingNormals::kPlain;
  return surface;
}

// Estevez, Lecocq and Lambert (2019) darken surfaces where their normals are tilted.
void ignore_shadowing(const Plugin& bsdf) {
  bsdf.ignore({"flip_invalid_normals"});
  if (bsdf.flag("use_shadowing_function", true))
    bsdf.warn("tilted normals do not darken the surface, as 'use_shadowing_function' does");
}

// A constant limited to [0, 1], with a warning; textures are limited where they are looked up.
ScalarParameter in_unit(const Plugin& bsdf, std::string_view name, ScalarParameter parameter) {
  if (parameter.texture >= 0) return parameter;
  const float given = parameter.value;
  parameter.value = std::clamp(given, 0.0f, 1.0f);
  if (parameter.value != given)
    bsdf.warn(fmt::format("range of {}", name),
              fmt::format("'{}' must be from 0 to 1; {:g} is used", name, parameter.value));
  return parameter;
}

// Mitsuba's masks do not weaken emission.
void undo_opacity(const Plugin& emitter, Material& material) {
  if (material.opacity.texture >= 0)
    return emitter.warn("what it emits is multiplied by the opacity of the surface");
  if (material.opacity.value > 0)
    material.emission.value = material.emission.value / material.opacity.value;
  else
    material.model = Null{};
}

}  // namespace

Surface one_sided(const Plugin& bsdf, MaterialModel model) {
  Surface surface;
  surface.material.name = bsdf.name();
  surface.material.model = std::move(model);
  surface.material.two_sided = false;
  surface.material.shading_normals = ShadingNormals::kPlain;
  return surface;
}

Surface open(const Plugin& bsdf, MaterialModel model) {
  Surface surface = one_sided(bsdf, std::move(model));
  surface.material.two_sided = true;
  return surface;
}

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
  material.emission = textures_.color(emitter, "radiance", Rgb::gray(1), site, kUnbounded);
  if (emitter.type() == "directionalarea") {
    emitter.warn("emits in all directions, with the same power");
    material.emission.value *= 1 / kPi;
  } else if (emitter.type() != "area") {
    emitter.warn("on a shape is not supported; an area light replaces it");
  }
  emitter.ignore({"sampling_weight"});
  material.two_sided_emission = false;
  material.visible_to_camera = !conversion_.hides_emitters;
  undo_opacity(emitter, material);
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
  if (type == "polarizer" || type == "circular") return straight(bsdf, site, 0.5f);
  if (type == "retarder") return straight(bsdf, site, 1);
  if (auto nearest = earlier(bsdf, site, depth)) return std::move(*nearest);
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

Surface MaterialConverter::straight(const Plugin& bsdf, const TextureSite& site, float share) {
  ThinDielectric pane;
  pane.ior = 1;
  pane.transmittance = textures_.color(bsdf, "transmittance", Rgb::gray(1), site);
  pane.transmittance.value *= share;
  bsdf.ignore({"theta", "delta", "left_handed"});
  bsdf.warn(fmt::format("does not polarize; a pane that lets {:g} of the light straight through replaces it",
                        share));
  return open(bsdf, pane);
}

Surface MaterialConverter::hair(const Plugin& bsdf, const TextureSite& site) {
  constexpr float kMaxMelanin = 1000, kMaxAbsorption = 100;  // more makes no light visible
  Hair model;
  model.beta_m = bsdf.real_in("longitudinal_roughness", 0.3f, 0, 1);
  model.beta_n = bsdf.real_in("azimuthal_roughness", 0.3f, 0, 1);
  model.tilt_degrees = bsdf.real_in("scale_tilt", 2, -kMaxHairTiltDegrees, kMaxHairTiltDegrees);
  model.ior = boundary_of(bsdf, "amber").ratio;
  if (!bsdf.has("sigma_a")) {
    model.eumelanin = bsdf.real_in("eumelanin", 1.3f, 0, kMaxMelanin);
    model.pheomelanin = bsdf.real_in("pheomelanin", 0.2f, 0, kMaxMelanin);
    bsdf.ignore({"scale"});
  } else {
    const float scale = bsdf.real_in("scale", 1, 0, kUnbounded);
    model.pigment = HairPigment::kAbsorption;
    model.sigma_a = textures_.color(bsdf, "sigma_a", Rgb{}, site, kUnbounded);
    const Rgb scaled = model.sigma_a.value * scale;
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
    conductor.tangent = rough.tangent;
    conductor.microfacets = rough.microfacets;
  }
  return one_sided(bsdf, conductor);
}

// Without a material, everything is reflected.
ComplexIndex MaterialConverter::metal(const Plugin& bsdf) {
  const ComplexIndex mirror{Rgb{}, Rgb::gray(1)};
  const std::string name = bsdf.text("material").value_or("none");
  if (name == "none") return mirror;
  const auto known = find_metal(name);
  if (!known) bsdf.warn(fmt::format("the metal {} is not known; aluminium replaces it", in_quotes(name)));
  const Metal metal = known.value_or(Metal{});
  if (known && !metal.is_substitute)
    bsdf.warn(fmt::format("color of {}", name),
              fmt::format("the colour of {} is that under D65; Mitsuba integrates its indices without one",
                          in_quotes(name)));
  if (metal.is_substitute)
    bsdf.warn(fmt::format("the indices of {} are not known; those of {} replace them", in_quotes(name),
                          scene_keys::kConductors[static_cast<std::size_t>(metal.conductor)]));
  return complex_index(metal.conductor);
}

namespace {

// Mitsuba's mean internal reflectance of rough plastic over ours. It weighs 64 cosines from 0 to 1 equally,
// both ends included, which is less than the integral.
float internal_reflection(const Plastic& plastic) {
  constexpr int kCosines = 64;
  const float alpha = std::max(plastic.roughness.value * plastic.roughness.value, kMinAlpha);
  const float eta = plastic.ior.value;
  if (plastic.roughness.texture >= 0 || eta == 1) return 1;
  float sum = 0;
  for (int i = 1; i < kCosines; ++i) {
    const float cosine = static_cast<float>(i) / (kCosines - 1);
    sum += 2 * cosine * single_reflection(plastic.microfacets, alpha, cosine, 1 / eta);
  }
  const DirectionalAlbedo& tables = DirectionalAlbedo::tables(plastic.microfacets);
  const float ours =
      tables.mean_scattered_inside(alpha, eta) - tables.mean_transmitted(alpha, eta) / (eta * eta);
  return std::clamp(sum / kCosines / ours, 0.0f, 1.0f);
}

}  // namespace

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
    plastic.internal_reflection = internal_reflection(plastic);
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
    return {in_unit(bsdf, "alpha", textures_.scalar(bsdf, "alpha", 0.1f, site, TexelMap::kSquareRoot)), 0,
            kind};
  const ScalarParameter of_u = textures_.scalar(bsdf, "alpha_u", 0.1f, site);
  const ScalarParameter of_v = textures_.scalar(bsdf, "alpha_v", 0.1f, site);
  if (of_u.texture >= 0 || of_v.texture >= 0) {
    bsdf.warn("'alpha_u' is used for both directions, because the alphas have textures");
    return {in_unit(bsdf, "alpha_u", textures_.scalar(bsdf, "alpha_u", 0.1f, site, TexelMap::kSquareRoot)), 0,
            kind};
  }
  const float u = in_unit(bsdf, "alpha_u", of_u).value, v = in_unit(bsdf, "alpha_v", of_v).value;
  const float rougher = std::max(u, v);
  const float anisotropy = rougher > 0 ? 1 - std::min(u, v) / rougher : 0;
  return {std::min(std::sqrt(std::sqrt((u * u + v * v) / 2)), 1.0f),
          anisotropy,
          kind,
          {.rotation = u < v ? 0.25f : 0.0f}};
}

// Both are Disney's model in Mitsuba, too. The diffuse transmission of the sheet goes up to 2.
Surface MaterialConverter::principled(const Plugin& bsdf, const TextureSite& site, bool is_thin) {
  bsdf.ignore({"main_specular_sampling_rate", "clearcoat_sampling_rate", "diffuse_reflectance_sampling_rate",
               "spec_reflect_sampling_rate", "spec_trans_sampling_rate", "diffuse_trans_sampling_rate"});
  const auto share = [&](const char* name, float otherwise) {
    return in_unit(bsdf, name, textures_.scalar(bsdf, name, otherwise, site));
  };
  Disney model;
  model.base_color = textures_.color(bsdf, "base_color", Rgb::gray(0.5f), site);
  model.roughness = share("roughness", 0.5f);
  model.anisotropic = share("anisotropic", 0);
  model.specular_tint = share("spec_tint", 0);
  model.specular_transmission = share("spec_trans", 0);
  model.flatness = share("flatness", 0);
  model.sheen = share("sheen", 0);
  model.sheen_tint = share("sheen_tint", 0);
  model.thin_walled = is_thin;
  if (is_thin) {
    model.ior = textures_.scalar(bsdf, "eta", 1.5f, site);
    model.diffuse_transmission = textures_.scalar(bsdf, "diff_trans", 0, site);
    model.diffuse_transmission.value /= 2;
    model.diffuse_transmission = in_unit(bsdf, "diff_trans", model.diffuse_transmission);
  } else {
    model.ior = bsdf.real_in("eta", index_of_specular(bsdf.real_in("specular", 0.5f, 0, 1)), 1, kMaxIor);
    model.metallic = share("metallic", 0);
    model.clearcoat = share("clearcoat", 0);
    model.clearcoat_gloss = share("clearcoat_gloss", 0);
  }
  if (model.ior.texture < 0) {
    const float limited = std::clamp(model.ior.value, 1.0f, kMaxIor);
    if (limited != model.ior.value) bsdf.warn(fmt::format("its index of refraction becomes {}", limited));
    model.ior.value = limited;
  }
  return transmits_light(model) ? open(bsdf, model) : one_sided(bsdf, model);
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
  model.weight = in_unit(bsdf, "weight", weight);
  return blended(bsdf, model);
}

Surface MaterialConverter::blended(const Plugin& bsdf, const Blend& model) {
  Surface result = one_sided(bsdf, model);
  for (const std::uint32_t index : {model.first, model.second})
    if (conversion_.builder.material(index).two_sided) result.material.two_sided = true;
  return result;
}

std::uint32_t MaterialConverter::part(const Plugin& bsdf, const TextureSite& site, int depth, bool is_back) {
  const std::pair key{Site{bsdf.id(), site.layout, site.attributes}, is_back};
  if (const auto known = parts_.find(key); known != parts_.end()) return known->second;
  const Surface& made = surface(bsdf, site, depth);
  if (made.is_reversed) bsdf.warn("its inside and outside are exchanged, because it is part of a blend");
  Material material = made.material;
  material.two_sided |= is_back;
  return parts_[key] = conversion_.builder.add_material(std::move(material));
}

Surface MaterialConverter::mask(const Plugin& bsdf, const TextureSite& site, int depth) {
  Surface result = inner(bsdf, site, depth);
  const ScalarParameter opacity = textures_.opacity(bsdf, site);
  const ScalarParameter inside = result.material.opacity;
  if (inside.texture >= 0 || inside.value < 1) bsdf.warn("the opacity inside of another one is left out");
  result.material.opacity = in_unit(bsdf, "opacity", opacity);
  return result;
}

Surface MaterialConverter::two_sided(const Plugin& bsdf, const TextureSite& site, int depth) {
  const std::vector<Plugin> sides = bsdf.children(Kind::kBsdf);
  if (sides.size() == 2 && depth < kMaxBlendDepth) {
    Blend model;
    model.first = part(sides[0], site, depth + 1);
    model.second = part(sides[1], site, depth + 1, true);
    model.by_side = true;
    return open(bsdf, model);
  }
  Surface result = inner(bsdf, site, depth);
  if (sides.size() > 1)
    bsdf.warn("has too many BSDFs, or is nested in blends too deeply; the first one is on both sides");
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
    result.material.bump = textures_.bump_map(*map, site);
    result.material.bump.height *= scale;
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
  const std::string measured = bsdf.text("filename").value_or("");
  bsdf.warn(measured.empty() ? "is not supported; a gray diffuse BSDF replaces it"
                             : fmt::format("is refused: {} cannot be read; a gray diffuse BSDF replaces it",
                                           in_quotes(measured)));
  bsdf.ignore_all();
  return one_sided(bsdf, Lambert{});
}

}  // namespace tessera::core::mitsuba
