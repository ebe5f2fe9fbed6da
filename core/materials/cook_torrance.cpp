#include "core/materials/cook_torrance.hpp"

#include "core/sampling/warp.hpp"

namespace tessera::core {

Rgb CookTorranceBsdf::reflectance(float cos_oh) const {
  return metal ? fresnel_conductor(cos_oh, metal->eta, metal->k) : fresnel_schlick(cos_oh, f0);
}

// The share that microfacets have in the light reflected to wo, if all of them lay flat.
float CookTorranceBsdf::specular_probability(float cos_o) const {
  if (is_black(diffuse)) return 1;
  const float shine = max_component(specular * reflectance(cos_o));
  return shine / (shine + max_component(diffuse));
}

float CookTorranceBsdf::masking_over_4_cos(float cos_o, float cos_i) const {
  if (masking == Masking::kSmith) return ggx.visible_from_both_over_4_cos(cos_o, cos_i);
  const float k = ggx.alpha() / 2;
  return 1 / (4 * (cos_o * (1 - k) + k) * (cos_i * (1 - k) + k));
}

BsdfValue CookTorranceBsdf::evaluate(Vec3 wo, Vec3 wi) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  const Vec3 h = normalize(wo + wi);
  const float cos_oh = dot(wo, h);
  const float facets = ggx.density(h) * masking_over_4_cos(wo.z, wi.z);
  const float pdf_h = sample_half_vector ? ggx.pdf_projected(h) : ggx.pdf_visible(wo, h);
  const float p = specular_probability(wo.z);
  return {(diffuse / kPi + specular * reflectance(cos_oh) * facets) * wi.z,
          p * pdf_h / (4 * cos_oh) + (1 - p) * pdf_cosine_hemisphere(wi.z)};
}

std::optional<BsdfSample> CookTorranceBsdf::sample(Vec3 wo, Vec2 u, float u_lobe) const {
  if (wo.z <= 0) return std::nullopt;
  Vec3 wi;
  if (u_lobe < specular_probability(wo.z)) {
    const Vec3 h = sample_half_vector ? ggx.sample_projected(u) : ggx.sample_visible(wo, u);
    if (dot(wo, h) <= 0) return std::nullopt;
    wi = normalize(reflect(wo, h));
  } else {
    wi = sample_cosine_hemisphere(u);
  }
  const BsdfValue value = evaluate(wo, wi);
  if (!(value.pdf > 0)) return std::nullopt;
  return weighed_sample(wi, value);
}

}  // namespace tessera::core
