// SPDX-License-Identifier: Apache-2.0
// Lobes (lobe.hpp) of microfacets: reflection by microfacets or a mirror, by any reflectance.
#pragma once

#include <type_traits>

#include "core/materials/anisotropic_ggx.hpp"
#include "core/materials/directional_albedo.hpp"
#include "core/materials/fresnel.hpp"
#include "core/materials/microfacets.hpp"
#include "core/shading/lobe.hpp"
#include "core/shading/thin_film.hpp"

namespace tessera::core::shading {

// Fresnel reflectances, by the cosine to the facet; `normal` is that at normal incidence.
template <typename T>
struct DielectricReflectance {
  RgbOf<T> operator()(T cos_i) const { return RgbOf<T>::gray(fresnel_dielectric<T>(cos_i, eta)); }
  RgbOf<T> normal() const { return RgbOf<T>::gray(normal_reflectance(eta)); }

  T eta = T(1.0f);
};

// A metal by its exact indices.
template <typename T>
struct ConductorReflectance {
  RgbOf<T> operator()(T cos_i) const { return fresnel_conductor(cos_i, eta, k); }
  RgbOf<T> normal() const { return (*this)(T(1.0f)); }

  RgbOf<T> eta, k;
};

// A metal by its colours head-on and at 82 degrees (Kutz, Hasan and Edmondson 2021).
template <typename T>
class EdgeTintReflectance {
 public:
  EdgeTintReflectance() = default;
  // `edge` is the colour at 82 degrees over that of Schlick's approximation.
  EdgeTintReflectance(RgbOf<T> f0, RgbOf<T> edge)
      : f0_(f0),
        dip_(fresnel_schlick(T(kEdgeCos), f0) * (RgbOf<T>::gray(1) - edge) / edge_shape(T(kEdgeCos))) {}

  RgbOf<T> operator()(T cos_i) const {
    const RgbOf<T> tinted = fresnel_schlick(cos_i, f0_) - dip_ * edge_shape(smaller(T(1.0f), cos_i));
    return {larger(T(0.0f), tinted.r), larger(T(0.0f), tinted.g), larger(T(0.0f), tinted.b)};
  }
  RgbOf<T> normal() const { return f0_; }

 private:
  static constexpr float kEdgeCos = 1.0f / 7;

  static T edge_shape(T cos_i) {
    const T m = 1 - cos_i, m2 = m * m;
    return cos_i * m2 * m2 * m2;
  }

  RgbOf<T> f0_, dip_;  // what is taken off at cos (1 - cos)^6
};

// A surface under a thin film.
template <typename T, typename Bare>
struct FilmedReflectance {
  RgbOf<T> operator()(T cos_i) const {
    const RgbOf<T> reflected = bare(cos_i) + film.change(cos_i);
    return {clamp_between(reflected.r, 0.0f, 1.0f), clamp_between(reflected.g, 0.0f, 1.0f),
            clamp_between(reflected.b, 0.0f, 1.0f)};
  }
  RgbOf<T> normal() const { return (*this)(T(1.0f)); }

  Bare bare;
  ThinFilmOf<T> film;
};
template <typename T>
using FilmedMetal = FilmedReflectance<T, EdgeTintReflectance<T>>;
template <typename T>
using FilmedDielectric = FilmedReflectance<T, DielectricReflectance<T>>;

template <typename T>
const DirectionalAlbedo& albedos_of(const AnisotropicGgxOf<T>&) {
  return DirectionalAlbedo::tables();
}
template <typename T>
const DirectionalAlbedo& albedos_of(const MicrofacetsOf<T>& facets) {
  return DirectionalAlbedo::tables(facets.kind());
}

// Reflection by microfacets, or by a mirror where `smooth`. Facets are AnisotropicGgxOf<T> or
// MicrofacetsOf<T>.
template <typename T, template <typename> typename Reflectance, typename Facets>
struct MicrofacetLobe {
  static constexpr bool kIsDiffuse = false;
  MaskOf<T> is_delta() const { return smooth; }
  MaskOf<T> transmits() const { return false; }
  BsdfValueOf<T> evaluate(Vec3Of<T> wo, Vec3Of<T> wi, T) const {
    const MaskOf<T> lit = !(smooth | (wi.z <= 0));
    if (!any(lit)) return {};
    const Vec3Of<T> h = normalize(wo + wi);
    const T cos_oh = dot(wo, h);
    const T reflected = facets.density(h) * facets.smith_visibility(wo, wi) * wi.z;
    return only_where<T>(lit, {reflectance(cos_oh) * compensation(wo.z) * reflected,
                               facets.pdf_visible(wo, h) / (4 * cos_oh)});
  }
  BsdfSampleOf<T> sample(Vec3Of<T> wo, Vec2Of<T> u, T) const {
    BsdfSampleOf<T> sample;
    if (!all(smooth)) {
      const Vec3Of<T> h = facets.sample_visible(wo, u);
      const Vec3Of<T> wi = normalize(reflect(wo, h));
      const MaskOf<T> found = !((dot(wo, h) <= 0) | (wi.z <= 0));
      sample = unweighed_sample<T>(found, wi);
    }
    return any(smooth) ? select(smooth, mirrored(wo), sample) : sample;
  }
  std::array<std::optional<BsdfSample>, 2> delta_branches(Vec3Of<T> wo) const {
    if (!smooth) return {};
    return {alone(mirrored(wo)), std::nullopt};
  }
  T albedo(T cos_o) const {
    T rough{};
    if (!all(smooth)) {
      const DirectionalAlbedo& tables = albedos_of(facets);
      if constexpr (std::is_same_v<Reflectance<T>, DielectricReflectance<T>>)
        rough =
            tables.template reflected<T>(cos_o, facets.mean_alpha(), reflectance.eta) * compensation(cos_o).r;
      else
        rough = tables.template reflecting<T>(cos_o, facets.mean_alpha()) *
                max_component(reflectance(cos_o) * compensation(cos_o));
    }
    return any(smooth) ? select(smooth, max_component(reflectance(cos_o)), rough) : rough;
  }

  Reflectance<T> reflectance;
  Facets facets;
  MaskOf<T> smooth{};
  MaskOf<T> compensated{};  // what is lost by single scattering is given back

 private:
  BsdfSampleOf<T> mirrored(Vec3Of<T> wo) const {
    return delta_sample_of<T>({-wo.x, -wo.y, wo.z}, reflectance(wo.z), false);
  }
  // Turquin 2019: the lost light leaves in the shape of the lobe, attenuated as if all of it met facets
  // head-on.
  RgbOf<T> compensation(T cos_o) const {
    if (!any(compensated)) return RgbOf<T>::gray(1);
    const T kept = albedos_of(facets).template reflecting<T>(cos_o, facets.mean_alpha());
    return select(compensated, plus_gray<T>(reflectance.normal() * (1 / kept - 1), 1.0f), RgbOf<T>::gray(1));
  }
};

template <typename T, template <typename> typename Reflectance>
using GgxLobe = MicrofacetLobe<T, Reflectance, AnisotropicGgxOf<T>>;

// Reflection by microfacets of other kinds than correlated GGX.
template <typename T, template <typename> typename Reflectance>
using OtherMicrofacetLobe = MicrofacetLobe<T, Reflectance, MicrofacetsOf<T>>;

}  // namespace tessera::core::shading
