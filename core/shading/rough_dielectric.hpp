// SPDX-License-Identifier: Apache-2.0
// A dielectric boundary of microfacets, each a smooth boundary (Walter et al. 2007). T is float for one
// point, or FloatN for one in each lane.
#pragma once

#include <cmath>

#include "core/materials/bsdf_sample.hpp"
#include "core/materials/fresnel.hpp"
#include "core/materials/microfacet.hpp"
#include "core/materials/microfacets.hpp"
#include "core/shading/dielectric_boundary.hpp"

namespace tessera::core::shading {

// Smith's terms by the cosines to the normal.
template <typename T>
T visible_share(const GgxOf<T>& facets, T cos_w) {
  return facets.visible(cos_w);
}
template <typename T>
T visible_share(const MicrofacetsOf<T>& facets, T cos_w) {
  return facets.visible(at_cosine(cos_w));
}
template <typename T>
T smith_term(const GgxOf<T>& facets, T cos_o, T cos_i) {
  return facets.smith_visibility(cos_o, cos_i);
}
template <typename T>
T smith_term(const MicrofacetsOf<T>& facets, T cos_o, T cos_i) {
  return facets.smith_visibility(at_cosine(cos_o), at_cosine(cos_i));
}

// The facets are isotropic: GgxOf<T> or MicrofacetsOf<T>.
template <typename T, typename Facets = GgxOf<T>>
struct RoughDielectricOf {
  MaskOf<T> is_delta() const { return false; }
  MaskOf<T> transmits() const { return true; }
  void scale_diffuse(T) {}
  BsdfValueOf<T> evaluate(Vec3Of<T> wo_local, Vec3Of<T> wi_local, T diffuse_cos) const;
  BsdfSampleOf<T> sample(Vec3Of<T> wo_local, Vec2Of<T> u, T u_lobe) const;

  Facets facets;
  DielectricBoundaryOf<T> boundary;  // whose eta must not be 1
  DielectricFresnelOf<T> fresnel;

 private:
  BsdfValueOf<T> evaluate_reflection(Vec3Of<T> wo_local, Vec3Of<T> wi_local) const;
  BsdfValueOf<T> evaluate_transmission(Vec3Of<T> wo_local, Vec3Of<T> wi_local) const;
  T solid_angle_ratio(T cos_oh, T cos_ih) const;
};
using RoughDielectricBsdf = RoughDielectricOf<float>;

// The solid angle of microfacet normals per solid angle of refracted directions (Walter et al. 2007, eq.
// 17).
template <typename T, typename Facets>
T RoughDielectricOf<T, Facets>::solid_angle_ratio(T cos_oh, T cos_ih) const {
  using std::fabs;
  const T eta = boundary.eta;
  const T sum = cos_oh + eta * cos_ih;
  return eta * eta * fabs(cos_ih) / (sum * sum);
}

// Walter et al. 2007, eq. 20.
template <typename T, typename Facets>
BsdfValueOf<T> RoughDielectricOf<T, Facets>::evaluate_reflection(Vec3Of<T> wo, Vec3Of<T> wi) const {
  const Vec3Of<T> h = normalize(wo + wi);
  const T cos_oh = dot(wo, h);
  const T reflected = fresnel(cos_oh, boundary.fresnel_eta);
  const T reflection = facets.density(h) * smith_term(facets, wo.z, wi.z) * wi.z;
  return {boundary.reflectance * (reflected * reflection),
          reflected * facets.pdf_visible(wo, h) / (4 * cos_oh)};
}

// Walter et al. 2007, eq. 21. Its eta^2 cancels against the compression of radiance (Veach 1997, section
// 5.2).
template <typename T, typename Facets>
BsdfValueOf<T> RoughDielectricOf<T, Facets>::evaluate_transmission(Vec3Of<T> wo, Vec3Of<T> wi) const {
  const T eta = boundary.eta;
  const Vec3Of<T> across = wo + wi * eta;
  const Vec3Of<T> h = normalize(select(across.z > 0, across, -across));
  const T cos_oh = dot(wo, h), cos_ih = dot(wi, h);
  const T passed = 1 - fresnel(cos_oh, boundary.fresnel_eta);
  const T ratio = solid_angle_ratio(cos_oh, cos_ih);
  const T refraction = 4 * facets.density(h) * smith_term(facets, wo.z, -wi.z) * cos_oh * -wi.z * ratio;
  const MaskOf<T> dark = (cos_oh <= 0) | (cos_ih >= 0);
  return {select(dark, RgbOf<T>{}, boundary.transmittance * (passed * refraction / (eta * eta))),
          select(dark, T(0.0f), passed * facets.pdf_visible(wo, h) * ratio)};
}

template <typename T, typename Facets>
BsdfValueOf<T> RoughDielectricOf<T, Facets>::evaluate(Vec3Of<T> wo, Vec3Of<T> wi, T) const {
  const MaskOf<T> lit = (wo.z > 0) & (wi.z != 0), reflects = wi.z > 0;
  const MaskOf<T> above = lit & reflects, below = lit & !reflects;
  BsdfValueOf<T> value{};
  if (any(above)) {
    const BsdfValueOf<T> reflected = evaluate_reflection(wo, wi);
    value = {select(above, reflected.value, RgbOf<T>{}), select(above, reflected.pdf, T(0.0f))};
  }
  if (any(below)) {
    const BsdfValueOf<T> transmitted = evaluate_transmission(wo, wi);
    value = {select(below, transmitted.value, value.value), select(below, transmitted.pdf, value.pdf)};
  }
  return value;
}

// Everything but the masking term cancels out of the weight (Heitz 2018).
template <typename T, typename Facets>
BsdfSampleOf<T> RoughDielectricOf<T, Facets>::sample(Vec3Of<T> wo, Vec2Of<T> u, T u_lobe) const {
  using std::fabs;
  const T eta = boundary.eta;
  const Vec3Of<T> h = facets.sample_visible(wo, u);
  const T cos_oh = dot(wo, h), pdf_h = facets.pdf_visible(wo, h);
  const T reflected = fresnel(cos_oh, boundary.fresnel_eta);
  const MaskOf<T> reflects = u_lobe < reflected;
  const auto [refracts, through] = refracted(wo, h, eta);
  const Vec3Of<T> wi = select(reflects, reflect(wo, h), through);
  const MaskOf<T> right_side = select_mask(reflects, !(wi.z <= 0), !(wi.z >= 0));
  const T cos_i = fabs(wi.z);
  const T unmasked = 4 * cos_i * wo.z * smith_term(facets, wo.z, cos_i) / visible_share(facets, wo.z);
  BsdfSampleOf<T> sample;
  sample.found = (wo.z > 0) & !(cos_oh <= 0) & (reflects | refracts) & right_side;
  sample.wi_local = wi;
  sample.transmitted = !reflects;
  sample.eta = select(reflects, T(1.0f), eta);
  sample.weight =
      select(reflects, boundary.reflectance * unmasked, boundary.transmittance * (unmasked / (eta * eta)));
  sample.pdf = select(reflects, reflected * pdf_h / (4 * cos_oh),
                      (1 - reflected) * pdf_h * solid_angle_ratio(cos_oh, dot(wi, h)));
  return sample;
}

}  // namespace tessera::core::shading
