// SPDX-License-Identifier: Apache-2.0
// The BSDFs of models that are no closures (layered_materials.hpp), with their textures evaluated. T is float
// for one point, or FloatN for one in each lane.
#pragma once

#include <cmath>

#include "core/materials/limits.hpp"
#include "core/materials/model_at.hpp"
#include "core/shading/cook_torrance.hpp"
#include "core/shading/lambert.hpp"
#include "core/shading/phong.hpp"
#include "core/shading/specular.hpp"

namespace tessera::core::shading {

template <typename T>
LambertBsdfOf<T> bsdf_at(const ModelAt<T, Lambert>& model) {
  return {model.at().tinted(model(&Lambert::albedo))};
}

template <typename T>
PhongBsdfOf<T> bsdf_at(const ModelAt<T, Phong>& model) {
  const RgbOf<T> diffuse = model.at().tinted(model(&Phong::diffuse)), specular = model(&Phong::specular);
  const RgbOf<T> scale = normalize_energy(diffuse, specular);
  return {diffuse * scale, specular * scale, clamp_between(model(&Phong::exponent), 0.0f, kMaxExponent),
          model.holds([](const Phong& m) { return m.lobe == PhongLobe::kNPlus2; })};
}

// Of dielectrics, with the base colour as far as it is that of the reflectance.
template <typename T>
RgbOf<T> normal_reflectance_at(const ModelAt<T, CookTorrance>& model) {
  const RgbOf<T> f0 = model(&CookTorrance::f0);
  if (!model.at().has_tint) return f0;
  const MaskOf<T> is_base = model.holds([](const CookTorrance& m) { return f0_is_base_color(m); });
  return select(is_base, f0 * model.at().tint, f0);
}

// `half_vector`: Sampling::kHalfVector.
template <typename T>
CookTorranceBsdfOf<T> bsdf_at(const ModelAt<T, CookTorrance>& model, MaskOf<T> half_vector) {
  const RgbOf<T> diffuse = model.at().tinted(model(&CookTorrance::diffuse)),
                 specular = model(&CookTorrance::specular);
  const RgbOf<T> scale = normalize_energy(diffuse, specular);
  const MaskOf<T> metal = model.holds([](const CookTorrance& m) { return m.conductor.has_value(); });
  RgbOf<T> eta, k;
  if (any(metal)) {
    eta = model.number(
        [](const CookTorrance& m) { return m.conductor ? complex_index(*m.conductor).eta : Rgb{}; });
    k = model.number(
        [](const CookTorrance& m) { return m.conductor ? complex_index(*m.conductor).k : Rgb{}; });
  }
  return {diffuse * scale,
          specular * scale,
          metal,
          normal_reflectance_at(model),
          eta,
          k,
          rough_ggx(model(&CookTorrance::roughness)),
          model.holds([](const CookTorrance& m) { return m.masking == Masking::kSchlick; }),
          half_vector};
}

// A mirror, a glass, or a pane that light passes straight (passes_straight), of which only reflection is
// left.
inline const Glass& glass_of(const Material& material) {
  static const Glass kNone;
  const auto* glass = std::get_if<Glass>(&material.model);
  return glass != nullptr ? *glass : kNone;
}
inline const ColorParameter& reflectance_of(const Material& material) {
  if (const auto* mirror = std::get_if<Mirror>(&material.model)) return mirror->reflectance;
  if (const auto* pane = std::get_if<ThinDielectric>(&material.model)) return pane->reflectance;
  return glass_of(material).reflectance;
}

template <typename T>
RgbOf<T> mirror_reflectance_at(const ModelAt<T, Material>& material, RgbOf<T> reflectance) {
  if (!material.at().has_tint) return reflectance;
  const MaskOf<T> mirror =
      material.holds([](const Material& m) { return std::holds_alternative<Mirror>(m.model); });
  return select(mirror, reflectance * material.at().tint, reflectance);
}

// `Facets` are those of all lanes that are rough (RoughDielectricOf).
template <typename T, typename Facets>
SpecularBsdfOf<T, Facets> specular_at(const MaterialsOf<T>& materials, const MaterialPointOf<T>& at) {
  using std::fabs;
  const ModelAt<T, Material> material(materials, at);
  const ModelAt<T, Glass> glass(parts_of(materials, [](const Material& m) { return &glass_of(m); }), at);
  const auto has_fresnel = [&](DielectricFresnel fresnel) {
    return glass.holds([fresnel](const Glass& m) { return m.fresnel == fresnel; });
  };
  const T ior =
      clamp_between(glass(&Glass::ior), glass.number([](const Glass& m) { return min_ior(m.ior); }), kMaxIor);
  const T alpha = squared_roughness(glass(&Glass::roughness));
  const RgbOf<T> reflectance = material(reflectance_of);
  DielectricBoundaryOf<T> boundary(ior, at.outside, reflectance, glass(&Glass::transmittance));
  if (at.wavelength != nullptr)
    boundary.disperse(*at.wavelength, ior, at.outside, glass.number([](const Glass& m) {
      return disperses(m) ? m.dispersion.inverse_abbe_number() : 0.0f;
    }));
  const DielectricFresnelOf<T> fresnel{has_fresnel(DielectricFresnel::kSchlick),
                                       has_fresnel(DielectricFresnel::kNone)};
  const MaskOf<T> is_glass =
      material.holds([](const Material& m) { return std::holds_alternative<Glass>(m.model); });
  const MaskOf<T> is_smooth = (alpha < kMinAlpha) | (fabs(ior - 1) < kMinBending),
                  is_rough = is_glass & !is_smooth;
  const T facet_alpha = larger(alpha, T(kMinAlpha));
  const Facets facets = [&] {
    if constexpr (std::is_same_v<Facets, GgxOf<T>>)
      return Facets(facet_alpha);
    else
      return Facets(glass.first().microfacets, facet_alpha);
  }();
  return {!is_glass,
          is_rough,
          {mirror_reflectance_at(material, reflectance)},
          {boundary, fresnel},
          {facets, boundary, fresnel}};
}

}  // namespace tessera::core::shading
