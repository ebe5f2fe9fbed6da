// SPDX-License-Identifier: Apache-2.0
// BSDFs of Mitsuba 0.x, as the nearest that there are.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "core/materials/fresnel.hpp"
#include "core/scene/mitsuba/materials.hpp"
#include "core/scene/mitsuba/parse_values.hpp"
#include "core/scene/mitsuba/refraction.hpp"

namespace tessera::core::mitsuba {
namespace {

void warn_of_nearest(const Plugin& bsdf, std::string_view nearest) {
  bsdf.warn(fmt::format("is one of Mitsuba 0.x; {} replaces it", nearest));
}

// The shares of `count` BSDFs; equal ones if the mixture does not give as many numbers. The last share is
// that of the light that none of them gets.
std::vector<float> shares_of(const Plugin& mixture, std::size_t count) {
  const auto numbers = parse_numbers(mixture.text("weights").value_or(""));
  std::vector<float> shares(count, 1 / static_cast<float>(count));
  const auto is_finite = [](double weight) { return std::isfinite(weight); };
  if (numbers && numbers->size() == count && std::ranges::all_of(*numbers, is_finite))
    std::transform(numbers->begin(), numbers->end(), shares.begin(),
                   [](double weight) { return std::max(static_cast<float>(weight), 0.0f); });
  else
    mixture.warn("'weights' has not as many finite numbers as there are BSDFs; all have the same weight");
  const float sum = std::accumulate(shares.begin(), shares.end(), 0.0f);
  if (sum > 1)
    for (float& share : shares) share /= sum;
  constexpr float kRounding = 1e-4f;
  shares.push_back(sum < 1 - kRounding ? 1 - sum : 0);
  return shares;
}

// A metal under a smooth or rough dielectric, which is not darkened by its inside.
Principled coated_metal(const ConductorMaterial& metal, const Plastic& coat) {
  const float index = coat.ior.value;
  Principled surface;
  surface.base_metalness = 1;
  const Rgb color = fresnel_conductor(1.0f, metal.eta.value / index, metal.k.value / index);
  surface.base_color = {color * metal.specular.value, metal.specular.texture};
  surface.specular_roughness = metal.roughness;
  surface.specular_roughness_anisotropy = metal.anisotropy;
  surface.tangent = metal.tangent;
  surface.coat_weight = 1;
  surface.coat_ior = coat.ior;
  surface.coat_roughness = coat.roughness;
  return surface;
}

}  // namespace

std::optional<Surface> MaterialConverter::earlier(const Plugin& bsdf, const TextureSite& site, int depth) {
  const std::string& type = bsdf.type();
  if (type == "roughdiffuse") return rough_diffuse(bsdf, site);
  if (type == "phong") return phong(bsdf, site);
  if (type == "ward") return ward(bsdf, site);
  if (type == "difftrans") return diffuse_transmission(bsdf, site);
  if (type == "coating" || type == "roughcoating") return coating(bsdf, site, depth, type != "coating");
  if (type == "mixturebsdf") return mixture(bsdf, site, depth);
  return std::nullopt;
}

// Alpha is the root mean square of slopes, as Beckmann's; Oren and Nayar's sigma is that over the root of 2.
Surface MaterialConverter::rough_diffuse(const Plugin& bsdf, const TextureSite& site) {
  warn_of_nearest(bsdf, "the rough diffuse base of 'principled'");
  bsdf.ignore({"use_fast_approx"});
  Principled model;
  model.base_color = textures_.color(bsdf, "reflectance", Rgb::gray(0.5f), site);
  model.base_diffuse_roughness = textures_.scalar(bsdf, "alpha", 0.2f, site);
  model.base_diffuse_roughness.value /= std::sqrt(2.0f);
  model.specular_weight = 0;
  return one_sided(bsdf, model);
}

Surface MaterialConverter::phong(const Plugin& bsdf, const TextureSite& site) {
  warn_of_nearest(bsdf, "the material 'phong'");
  Phong model;
  model.diffuse = textures_.color(bsdf, "diffuse_reflectance", Rgb::gray(0.5f), site);
  model.specular = textures_.color(bsdf, "specular_reflectance", Rgb::gray(0.2f), site);
  model.exponent = textures_.scalar(bsdf, "exponent", 30, site);
  return one_sided(bsdf, model);
}

// Ward's highlight falls with exp(-tan^2 h / alpha^2) of the half vector's angle h, and Phong's with cos^n of
// about 2 h: near the mirror direction they are alike for n = 1 / (2 alpha^2).
Surface MaterialConverter::ward(const Plugin& bsdf, const TextureSite& site) {
  constexpr float kMinWardAlpha = 0.01f;
  const float alpha_u = bsdf.real_in("alpha_u", 0.1f, kMinWardAlpha, 1);
  const float alpha_v = bsdf.real_in("alpha_v", 0.1f, kMinWardAlpha, 1);
  warn_of_nearest(
      bsdf, alpha_u == alpha_v ? "the material 'phong'" : "the material 'phong', which is not anisotropic,");
  bsdf.ignore({"variant"});
  Phong model;
  model.diffuse = textures_.color(bsdf, "diffuse_reflectance", Rgb::gray(0.5f), site);
  model.specular = textures_.color(bsdf, "specular_reflectance", Rgb::gray(0.2f), site);
  model.exponent = 1 / (2 * alpha_u * alpha_v);
  return one_sided(bsdf, model);
}

Surface MaterialConverter::diffuse_transmission(const Plugin& bsdf, const TextureSite& site) {
  warn_of_nearest(bsdf, "the material 'diffuse_transmission'");
  return open(bsdf,
              DiffuseTransmission{{Rgb{}}, textures_.color(bsdf, "transmittance", Rgb::gray(0.5f), site)});
}

Surface MaterialConverter::coating(const Plugin& bsdf, const TextureSite& site, int depth, bool is_rough) {
  Surface result = inner(bsdf, site, depth);
  Plastic coat;
  coat.ior = boundary_of(bsdf, "bk7").ratio;
  coat.specular = textures_.color(bsdf, "specular_reflectance", Rgb::gray(1), site);
  coat.nonlinear = true;
  if (is_rough) {
    const Roughness rough = roughness(bsdf, site);
    coat.roughness = rough.roughness;
    coat.microfacets = rough.microfacets;
  }
  MaterialModel& model = result.material.model;
  const auto* diffuse = std::get_if<Lambert>(&model);
  const auto* metal = std::get_if<ConductorMaterial>(&model);
  if (diffuse != nullptr) {
    warn_of_nearest(bsdf, "the material 'plastic' of the colour inside of it");
    coat.diffuse = diffuse->albedo;
    model = coat;
  } else if (metal != nullptr && metal->eta.texture < 0 && metal->k.texture < 0) {
    warn_of_nearest(bsdf, "a metal under the coat of 'principled'");
    model = coated_metal(*metal, coat);
  } else {
    warn_of_nearest(bsdf, "the BSDF inside of it");
  }
  return result;
}

// A chain of blends, and black for the share of no BSDF.
Surface MaterialConverter::mixture(const Plugin& bsdf, const TextureSite& site, int depth) {
  const std::vector<Plugin> mixed = bsdf.children(Kind::kBsdf);
  if (mixed.empty() || depth + static_cast<int>(mixed.size()) > kMaxBlendDepth) {
    if (!mixed.empty())
      bsdf.warn("has too many BSDFs, or is nested in blends too deeply; the first one replaces it");
    bsdf.ignore({"weights"});
    return inner(bsdf, site, depth + 1);
  }
  warn_of_nearest(bsdf, "the material 'blend'");
  const std::vector<float> shares = shares_of(bsdf, mixed.size());
  float rest = shares.back();
  std::optional<std::uint32_t> others;  // the material of the rest
  if (rest > 0) others = conversion_.builder.add_material(one_sided(bsdf, Lambert{{Rgb{}}}).material);
  const auto blend_with_others = [&](std::size_t i) {
    Blend model;
    model.first = part(mixed[i], site, depth + static_cast<int>(i) + 1);
    model.second = *others;
    model.weight = rest > 0 ? rest / (rest + shares[i]) : 0.0f;
    return blended(bsdf, model);
  };
  for (std::size_t i = mixed.size() - 1; i > 0; --i) {
    others = others ? conversion_.builder.add_material(blend_with_others(i).material)
                    : part(mixed[i], site, depth + static_cast<int>(i) + 1);
    rest += shares[i];
  }
  return others ? blend_with_others(0) : inner(bsdf, site, depth + 1);
}

}  // namespace tessera::core::mitsuba
