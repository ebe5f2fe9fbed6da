// SPDX-License-Identifier: Apache-2.0
#include "core/shading/disney_bsdf.hpp"

#include <algorithm>
#include <cmath>

#include "core/materials/fresnel.hpp"
#include "core/materials/limits.hpp"
#include "core/materials/material.hpp"
#include "core/math/elementary.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core {
namespace {

constexpr float kClearcoatF0 = 0.04f, kClearcoatWeight = 0.25f, kClearcoatMaskingAlpha = 0.25f;
constexpr float kSheenAlbedo = 0.2f;  // roughly, for sampling

float share(float value) {
  return value > 0 ? std::min(value, 1.0f) : 0.0f;
}

Rgb share(Rgb color) {
  return {share(color.r), share(color.g), share(color.b)};
}

float lerp(float a, float b, float t) {
  return a + (b - a) * t;
}

Rgb root(Rgb color) {
  return {std::sqrt(color.r), std::sqrt(color.g), std::sqrt(color.b)};
}

// Schlick's weight of the reflectance at grazing angles.
float grazing(float cosine) {
  return fifth_power(1 - std::clamp(cosine, 0.0f, 1.0f));
}

Vec3 mirrored_below(Vec3 w) {
  return {w.x, w.y, -w.z};
}

Microfacets separable_ggx(float roughness, float anisotropic) {
  const float alpha = squared_roughness(roughness), aspect = std::sqrt(1 - 0.9f * anisotropic);
  const auto limited = [](float a) { return std::clamp(a, kMinAlpha, 1.0f); };
  return {{MicrofacetDistribution::kGgx, SmithMasking::kSeparable},
          limited(alpha / aspect),
          limited(alpha * aspect)};
}

}  // namespace

DisneyBsdf::DisneyBsdf(const Disney& model, const std::vector<Texture>& textures, const UvSets& uv,
                       bool outside, Rgb tint)
    : thin_(model.thin_walled) {
  const auto at = [&](const ScalarParameter& parameter) { return share(parameter.evaluate(textures, uv)); };
  const float ior = std::clamp(model.ior.evaluate(textures, uv), 1.0f, kMaxIor);
  base_color_ = share(share(model.base_color.evaluate(textures, uv)) * tint);
  roughness_ = at(model.roughness);
  const bool inside = !outside && !thin_ && transmits_light(model);
  const float metallic = thin_ ? 0 : at(model.metallic), transmission = at(model.specular_transmission);
  clear_ = (1 - metallic) * transmission;
  eta_ = clear_ > 0 ? std::max(ior, 1 + kMinBending) : ior;
  if (inside) eta_ = 1 / eta_;
  set_facets(roughness_, at(model.anisotropic), ior);
  const float specular_tint = at(model.specular_tint);
  set_colors(specular_tint, at(model.sheen_tint), ior);
  dielectric_ = clear_;
  if (inside) return;
  const float reflecting = thin_ ? transmission : 1 - metallic;
  dielectric_ = reflecting * (1 - specular_tint);
  tinted_ = reflecting * specular_tint;
  metal_ = metallic;
  const float through = thin_ ? at(model.diffuse_transmission) : 0;
  const float opaque = (1 - metallic) * (1 - transmission);
  diffuse_ = opaque * (1 - through);
  diffuse_through_ = opaque * through;
  flatness_ = at(model.flatness);
  sheen_ = at(model.sheen) * (thin_ ? diffuse_ : 1 - metallic);
  clearcoat_ = thin_ ? 0 : at(model.clearcoat);
  if (clearcoat_ == 0) return;
  const float alpha = lerp(0.1f, 0.001f, at(model.clearcoat_gloss));
  clearcoat_alpha2_ = alpha * alpha;
  const auto log_alpha2 = static_cast<float>(log(static_cast<double>(clearcoat_alpha2_)));
  clearcoat_norm_ = (clearcoat_alpha2_ - 1) / (kPi * log_alpha2);
}

// What a sheet transmits is blurred less, the lower the index (Burley 2015, figure 15).
void DisneyBsdf::set_facets(float roughness, float anisotropic, float ior) {
  facets_ = separable_ggx(roughness, anisotropic);
  if (thin_) sheet_facets_ = separable_ggx(share((0.65f * ior - 0.35f) * roughness), anisotropic);
}

void DisneyBsdf::set_colors(float specular_tint, float sheen_tint, float ior) {
  // Two crossings of a solid give the base colour.
  transmission_color_ = thin_ ? base_color_ : root(base_color_);
  sheen_color_ = Rgb::gray(1);
  if (specular_tint == 0 && sheen_tint == 0) return;
  const float brightness = luminance(base_color_);
  const Rgb hue = brightness > 0 ? base_color_ / brightness : Rgb::gray(1);
  const float contrast = (ior - 1) / (ior + 1);
  tinted_f0_ = share(hue * (contrast * contrast));
  sheen_color_ = Rgb::gray(1) + (hue - Rgb::gray(1)) * sheen_tint;
}

void DisneyBsdf::orient(Vec3 tangent_local) {
  const float length2 = tangent_local.x * tangent_local.x + tangent_local.y * tangent_local.y;
  if (!(length2 > 0)) return;
  const float scale = 1 / std::sqrt(length2);
  tangent_ = {tangent_local.x * scale, tangent_local.y * scale};
}

// Burley 2012, section 5.4, with Fresnel's exact reflectance of a dielectric that is not tinted.
Rgb DisneyBsdf::reflectance(float cos_h) const {
  Rgb sum = Rgb::gray(dielectric_ * fresnel_dielectric(cos_h, eta_));
  if (metal_ > 0) sum += fresnel_schlick(cos_h, base_color_) * metal_;
  if (tinted_ > 0) sum += fresnel_schlick(cos_h, tinted_f0_) * tinted_;
  return sum;
}

Rgb DisneyBsdf::transmittance(float cos_h) const {
  return transmission_color_ * (clear_ * (1 - fresnel_dielectric(cos_h, eta_)));
}

DisneyBsdf::Chances DisneyBsdf::chances(float cos_o) const {
  Chances all{};
  const float base = max_component(base_color_);
  all[kFacets] = max_component(reflectance(cos_o));
  if (clear_ > 0) all[kFacets] += max_component(transmittance(cos_o));
  all[kClearcoat] = clearcoat_ * lerp(kClearcoatF0, 1, grazing(cos_o)) * cos_o;
  all[kDiffuse] = diffuse_ * base + sheen_ * max_component(sheen_color_) * kSheenAlbedo;
  all[kThrough] = diffuse_through_ * base;
  const float sum = all[kFacets] + all[kClearcoat] + all[kDiffuse] + all[kThrough];
  for (float& chance : all) chance = sum > 0 ? chance / sum : 0;
  return all;
}

float DisneyBsdf::transmission_chance(float cos_h) const {
  if (!(clear_ > 0)) return 0;
  const float passed = max_component(transmittance(cos_h)), thrown_back = max_component(reflectance(cos_h));
  return passed > 0 ? passed / (passed + thrown_back) : 0;
}

// Burley 2015, eq. 4 and section 5.3, without the cosine; cos_d is that of the angle to the half vector.
Rgb DisneyBsdf::diffuse(float cos_o, float cos_i, float cos_d) const {
  const float o = grazing(cos_o), i = grazing(cos_i), retro = 2 * roughness_ * cos_d * cos_d;
  float shape = (1 - 0.5f * o) * (1 - 0.5f * i) + retro * (o + i + o * i * (retro - 1));
  if (flatness_ > 0) {
    const float below = lerp(1, retro / 2, o) * lerp(1, retro / 2, i);
    shape = lerp(shape, 1.25f * (below * (1 / (cos_o + cos_i) - 0.5f) + 0.5f), flatness_);
  }
  return (base_color_ * (diffuse_ * shape / kPi) + sheen_color_ * (sheen_ * grazing(cos_d))) * diffuse_scale_;
}

// GTR of exponent 1 (Burley 2012, eq. 4 of appendix B).
float DisneyBsdf::clearcoat_density(Vec3 h) const {
  return clearcoat_norm_ / (h.x * h.x + h.y * h.y + clearcoat_alpha2_ * h.z * h.z);
}

// Normals in proportion to D cos (ibid., eq. 5).
Vec3 DisneyBsdf::sample_clearcoat(Vec2 u) const {
  const auto alpha2 = static_cast<double>(clearcoat_alpha2_);
  const double sin2 = (pow(alpha2, 1 - static_cast<double>(u.x)) - alpha2) / (1 - alpha2);
  const auto [s, c] = sin_cos_turns(u.y);
  const auto sine = static_cast<float>(std::sqrt(std::max(0.0, sin2)));
  return {sine * c, sine * s, static_cast<float>(std::sqrt(std::max(0.0, 1 - sin2)))};
}

BsdfValue DisneyBsdf::reflected(Vec3 wo, Vec3 wi, float diffuse_cos) const {
  const Chances chance = chances(wo.z);
  const Vec3 h = normalize(wo + wi);
  const float cos_h = dot(wo, h), per_direction = 1 / (4 * cos_h);
  const float stays = 1 - transmission_chance(thin_ ? wo.z : cos_h);
  BsdfValue sum;
  sum.value = reflectance(cos_h) * (facets_.density(h) * facets_.smith_visibility(wo, wi) * wi.z);
  sum.pdf = chance[kFacets] * stays * facets_.pdf_visible(wo, h) * per_direction;
  if (clearcoat_ > 0) {
    const Ggx masking(kClearcoatMaskingAlpha);
    const float density = clearcoat_density(h);
    const float unmasked = masking.visible(wo.z) * masking.visible(wi.z);
    sum.value += Rgb::gray(clearcoat_ * kClearcoatWeight * lerp(kClearcoatF0, 1, grazing(cos_h)) * density *
                           unmasked * wi.z);
    sum.pdf += chance[kClearcoat] * density * h.z * per_direction;
  }
  if (diffuse_ > 0 || sheen_ > 0) sum.value += diffuse(wo.z, wi.z, cos_h) * diffuse_cos;
  sum.pdf += chance[kDiffuse] * pdf_cosine_hemisphere(wi.z);
  return sum;
}

// Walter et al. 2007, eq. 17 and 21. Its eta^2 cancels against the compression of radiance (Veach 1997,
// section 5.2).
BsdfValue DisneyBsdf::refracted_through_facets(Vec3 wo, Vec3 wi) const {
  const Vec3 across = wo + wi * eta_;
  const Vec3 h = normalize(across.z > 0 ? across : -across);
  const float cos_oh = dot(wo, h), cos_ih = dot(wi, h);
  if (!(cos_oh > 0 && cos_ih < 0)) return {};
  const float sum = cos_oh + eta_ * cos_ih, ratio = eta_ * eta_ * -cos_ih / (sum * sum);
  const float visibility = facets_.smith_visibility(wo, mirrored_below(wi));
  const float passed = 4 * facets_.density(h) * visibility * cos_oh * -wi.z * ratio / (eta_ * eta_);
  return {transmittance(cos_oh) * passed,
          chances(wo.z)[kFacets] * transmission_chance(cos_oh) * facets_.pdf_visible(wo, h) * ratio};
}

// Specular transmission as a reflection to the other side, and diffuse transmission.
BsdfValue DisneyBsdf::passed_through_sheet(Vec3 wo, Vec3 wi) const {
  const Chances chance = chances(wo.z);
  const Vec3 above = mirrored_below(wi), h = normalize(wo + above);
  const float cos_h = dot(wo, h);
  BsdfValue sum{base_color_ * (diffuse_through_ * above.z / kPi),
                chance[kThrough] * pdf_cosine_hemisphere(above.z)};
  if (clear_ > 0) {
    const float visibility = sheet_facets_.smith_visibility(wo, above);
    sum.value += transmittance(cos_h) * (sheet_facets_.density(h) * visibility * above.z);
    sum.pdf += chance[kFacets] * transmission_chance(wo.z) * sheet_facets_.pdf_visible(wo, h) / (4 * cos_h);
  }
  return sum;
}

BsdfValue DisneyBsdf::evaluate_turned(Vec3 wo, Vec3 wi, float diffuse_cos) const {
  if (!(wo.z > 0) || wi.z == 0) return {};
  if (wi.z > 0) return reflected(wo, wi, diffuse_cos);
  if (!transmits()) return {};
  return thin_ ? passed_through_sheet(wo, wi) : refracted_through_facets(wo, wi);
}

namespace {

// Coordinates by a tangent, and back.
Vec3 by_tangent(Vec2 t, Vec3 w) {
  return {t.x * w.x + t.y * w.y, t.x * w.y - t.y * w.x, w.z};
}
Vec3 from_tangent(Vec2 t, Vec3 w) {
  return {t.x * w.x - t.y * w.y, t.x * w.y + t.y * w.x, w.z};
}

}  // namespace

BsdfValue DisneyBsdf::evaluate(Vec3 wo_local, Vec3 wi_local, float diffuse_cos) const {
  return evaluate_turned(by_tangent(tangent_, wo_local), by_tangent(tangent_, wi_local), diffuse_cos);
}

std::optional<Vec3> DisneyBsdf::sample_facets(Vec3 wo, Vec2 u, float u_side) const {
  if (thin_ && u_side < transmission_chance(wo.z)) {
    const Vec3 above = reflect(wo, sheet_facets_.sample_visible(wo, u));
    return above.z > 0 ? std::optional(mirrored_below(above)) : std::nullopt;
  }
  const Vec3 h = facets_.sample_visible(wo, u);
  const float cos_h = dot(wo, h);
  if (!(cos_h > 0)) return std::nullopt;
  if (!thin_ && u_side < transmission_chance(cos_h)) {
    const auto wi = refract(wo, h, eta_);
    return wi && wi->z < 0 ? wi : std::nullopt;
  }
  const Vec3 wi = reflect(wo, h);
  return wi.z > 0 ? std::optional(wi) : std::nullopt;
}

std::optional<BsdfSample> DisneyBsdf::sample(Vec3 wo_local, Vec2 u, float u_lobe) const {
  if (!(wo_local.z > 0)) return std::nullopt;
  const Vec3 wo = by_tangent(tangent_, wo_local);
  const Chances chance = chances(wo.z);
  std::optional<Vec3> wi;
  if (u_lobe < chance[kFacets]) {
    wi = sample_facets(wo, u, u_lobe / chance[kFacets]);
  } else if (u_lobe < chance[kFacets] + chance[kClearcoat]) {
    const Vec3 mirrored = reflect(wo, sample_clearcoat(u));
    if (mirrored.z > 0) wi = mirrored;
  } else {
    wi = sample_cosine_hemisphere(u);
    if (u_lobe >= 1 - chance[kThrough]) wi = mirrored_below(*wi);
  }
  if (!wi) return std::nullopt;
  const BsdfValue value = evaluate_turned(wo, *wi, wi->z);
  if (!(value.pdf > 0)) return std::nullopt;
  BsdfSample sample = weighed_sample(from_tangent(tangent_, *wi), value);
  sample.transmitted = wi->z < 0;
  if (sample.transmitted) sample.eta = transmitted_eta();
  return sample;
}

}  // namespace tessera::core
