// SPDX-License-Identifier: Apache-2.0
// GGX microfacet reflection over a diffuse base (Cook and Torrance 1982; Walter et al. 2007).
#pragma once

#include "core/materials/bsdf_sample.hpp"
#include "core/materials/fresnel.hpp"
#include "core/materials/microfacet.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core::shading {

// T is float for one point, or FloatN for one in each lane.
template <typename T>
struct CookTorranceBsdfOf {
  MaskOf<T> is_delta() const { return false; }
  MaskOf<T> transmits() const { return false; }
  void scale_diffuse(T factor) { diffuse *= factor; }

  BsdfValueOf<T> evaluate(Vec3Of<T> wo_local, Vec3Of<T> wi_local, T diffuse_cos) const {
    return evaluate(wo_local, wi_local, diffuse_cos, specular_probability(wo_local.z));
  }

  BsdfSampleOf<T> sample(Vec3Of<T> wo_local, Vec2Of<T> u, T u_lobe) const;

  RgbOf<T> diffuse, specular;  // diffuse + specular <= 1, except after scale_diffuse
  MaskOf<T> is_metal;
  RgbOf<T> f0;      // for dielectrics
  RgbOf<T> eta, k;  // for metals
  GgxOf<T> ggx;
  MaskOf<T> schlick_masking;     // Masking::kSchlick
  MaskOf<T> sample_half_vector;  // else the distribution of visible normals

 private:
  RgbOf<T> reflectance(T cos_oh) const {
    const RgbOf<T> dielectric = fresnel_schlick(cos_oh, f0);
    return any(is_metal) ? select(is_metal, fresnel_conductor(cos_oh, eta, k), dielectric) : dielectric;
  }

  // The microfacets' share of the light reflected to wo, computed for flat microfacets.
  T specular_probability(T cos_o) const {
    const T highlight = max_component(specular * reflectance(cos_o));
    return select(is_black(diffuse), T(1.0f), highlight / (highlight + max_component(diffuse)));
  }

  T visibility_term(T cos_o, T cos_i) const {
    const T smith = ggx.smith_visibility(cos_o, cos_i);
    if (!any(schlick_masking)) return smith;
    const T k_half = ggx.alpha() / 2;
    const T schlick = 1 / (4 * (cos_o * (1 - k_half) + k_half) * (cos_i * (1 - k_half) + k_half));
    return select(schlick_masking, schlick, smith);
  }

  Vec3Of<T> sample_facet(Vec3Of<T> wo, Vec2Of<T> u) const {
    if (all(sample_half_vector)) return ggx.sample_projected(u);
    const Vec3Of<T> visible = ggx.sample_visible(wo, u);
    return any(sample_half_vector) ? select(sample_half_vector, ggx.sample_projected(u), visible) : visible;
  }

  BsdfValueOf<T> evaluate(Vec3Of<T> wo, Vec3Of<T> wi, T diffuse_cos, T p) const;
};
using CookTorranceBsdf = CookTorranceBsdfOf<float>;

// `p` is the probability of the specular lobe.
template <typename T>
BsdfValueOf<T> CookTorranceBsdfOf<T>::evaluate(Vec3Of<T> wo, Vec3Of<T> wi, T diffuse_cos, T p) const {
  const MaskOf<T> dark = (wo.z <= 0) | (wi.z <= 0);
  const Vec3Of<T> h = normalize(wo + wi);
  const T cos_oh = dot(wo, h);
  const T facets = ggx.density(h) * visibility_term(wo.z, wi.z);
  const T pdf_h = select(sample_half_vector, ggx.pdf_projected(h), ggx.pdf_visible(wo, h));
  const RgbOf<T> value = diffuse * (diffuse_cos / kPi) + specular * reflectance(cos_oh) * (facets * wi.z);
  const T pdf = p * pdf_h / (4 * cos_oh) + (1 - p) * sampling::pdf_cosine_hemisphere(wi.z);
  return {select(dark, RgbOf<T>{}, value), select(dark, T(0.0f), pdf)};
}

template <typename T>
BsdfSampleOf<T> CookTorranceBsdfOf<T>::sample(Vec3Of<T> wo, Vec2Of<T> u, T u_lobe) const {
  const T p = specular_probability(wo.z);
  const MaskOf<T> specular_lobe = u_lobe < p;
  MaskOf<T> found = wo.z > 0;
  Vec3Of<T> wi = sampling::sample_cosine_hemisphere(u);
  if (any(specular_lobe)) {
    const Vec3Of<T> h = sample_facet(wo, u);
    const MaskOf<T> diffuse_lobe = !specular_lobe;
    found = found & (diffuse_lobe | (dot(wo, h) > 0));
    wi = select(specular_lobe, normalize(reflect(wo, h)), wi);
  }
  const BsdfValueOf<T> value = evaluate(wo, wi, wi.z, p);
  found = found & (value.pdf > 0);
  return {found, false, false, wi, value.value / value.pdf, value.pdf, T(1.0f)};
}

}  // namespace tessera::core::shading
