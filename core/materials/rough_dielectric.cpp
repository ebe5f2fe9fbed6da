// SPDX-License-Identifier: Apache-2.0
#include "core/materials/rough_dielectric.hpp"

#include <cmath>

namespace tessera::core {

// The solid angle of microfacet normals per solid angle of refracted directions (Walter et al. 2007, eq.
// 17).
float RoughDielectricBsdf::solid_angle_ratio(float cos_oh, float cos_ih) const {
  const float sum = cos_oh + eta * cos_ih;
  return eta * eta * std::fabs(cos_ih) / (sum * sum);
}

// Walter et al. 2007, eq. 20.
BsdfValue RoughDielectricBsdf::evaluate_reflection(Vec3 wo, Vec3 wi) const {
  const Vec3 h = normalize(wo + wi);
  const float cos_oh = dot(wo, h);
  const float reflected = dielectric_reflectance(fresnel, cos_oh, eta);
  const float facets = ggx.density(h) * ggx.smith_visibility(wo.z, wi.z) * wi.z;
  return {reflectance * (reflected * facets), reflected * ggx.pdf_visible(wo, h) / (4 * cos_oh)};
}

// Walter et al. 2007, eq. 21. Its eta^2 cancels against the compression of radiance (Veach 1997, section
// 5.2).
BsdfValue RoughDielectricBsdf::evaluate_transmission(Vec3 wo, Vec3 wi) const {
  const Vec3 across = wo + wi * eta;
  const Vec3 h = normalize(across.z > 0 ? across : -across);
  const float cos_oh = dot(wo, h), cos_ih = dot(wi, h);
  if (cos_oh <= 0 || cos_ih >= 0) return {};
  const float passed = 1 - dielectric_reflectance(fresnel, cos_oh, eta);
  const float ratio = solid_angle_ratio(cos_oh, cos_ih);
  const float facets = 4 * ggx.density(h) * ggx.smith_visibility(wo.z, -wi.z) * cos_oh * -wi.z * ratio;
  return {transmittance * (passed * facets / (eta * eta)), passed * ggx.pdf_visible(wo, h) * ratio};
}

BsdfValue RoughDielectricBsdf::evaluate(Vec3 wo, Vec3 wi, float) const {
  if (wo.z <= 0 || wi.z == 0) return {};
  return wi.z > 0 ? evaluate_reflection(wo, wi) : evaluate_transmission(wo, wi);
}

// Everything but the masking term cancels out of the weight (Heitz 2018).
std::optional<BsdfSample> RoughDielectricBsdf::sample(Vec3 wo, Vec2 u, float u_lobe) const {
  if (wo.z <= 0) return std::nullopt;
  const Vec3 h = ggx.sample_visible(wo, u);
  const float cos_oh = dot(wo, h), pdf_h = ggx.pdf_visible(wo, h);
  if (cos_oh <= 0) return std::nullopt;
  const float reflected = dielectric_reflectance(fresnel, cos_oh, eta);
  const bool reflects = u_lobe < reflected;
  const auto wi = reflects ? reflect(wo, h) : refract(wo, h, eta);
  if (!wi || (reflects ? wi->z <= 0 : wi->z >= 0)) return std::nullopt;
  const float cos_i = std::fabs(wi->z);
  const float unmasked = 4 * cos_i * wo.z * ggx.smith_visibility(wo.z, cos_i) / ggx.visible(wo.z);
  BsdfSample sample;
  sample.wi_local = *wi;
  sample.transmitted = !reflects;
  sample.eta = reflects ? 1 : eta;
  sample.weight = reflects ? reflectance * unmasked : transmittance * (unmasked / (eta * eta));
  sample.pdf = reflects ? reflected * pdf_h / (4 * cos_oh)
                        : (1 - reflected) * pdf_h * solid_angle_ratio(cos_oh, dot(*wi, h));
  return sample;
}

}  // namespace tessera::core
