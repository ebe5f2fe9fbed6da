// SPDX-License-Identifier: Apache-2.0
// Disney's principled BSDF (Burley 2012, 2015): GGX reflection of a dielectric or a metal, with transmission,
// a clearcoat of the GTR1 distribution, and diffuse reflection with retro-reflection and sheen. The thin
// sheet is that of Burley 2015, section 5.3. Masking is separable. T is float for one point, or FloatN for
// one in each lane.
#pragma once

#include "core/materials/bsdf_sample.hpp"
#include "core/materials/microfacets.hpp"
#include "core/materials/model_at.hpp"

namespace tessera::core::shading {

template <typename T>
class DisneyBsdfOf {
 public:
  DisneyBsdfOf() = default;
  // Directions are those of bsdf.hpp.
  explicit DisneyBsdfOf(const ModelAt<T, Disney>& model);

  void orient(Vec3Of<T> tangent_local);
  MaskOf<T> is_delta() const { return false; }
  MaskOf<T> transmits() const { return (clear_ > 0) | (diffuse_through_ > 0); }
  void scale_diffuse(T factor) { diffuse_scale_ = diffuse_scale_ * factor; }
  BsdfValueOf<T> evaluate(Vec3Of<T> wo_local, Vec3Of<T> wi_local, T diffuse_cos) const;
  BsdfSampleOf<T> sample(Vec3Of<T> wo_local, Vec2Of<T> u, T u_lobe) const;

  // The index of refraction on the far side over the near side.
  T transmitted_eta() const { return select(thin_, T(1.0f), eta_); }

 private:
  struct Chances {
    T facets, clearcoat, diffuse, through;  // through: diffuse transmission
  };
  // A direction, in coordinates by the tangent.
  struct Direction {
    MaskOf<T> found;
    Vec3Of<T> wi;
  };
  using Model = ModelAt<T, Disney>;

  void set_facets(T anisotropic, T ior);
  void set_colors(T specular_tint, T sheen_tint, T ior);
  void set_weights(const Model& model, T specular_tint, T metallic, T transmission);
  void set_clearcoat(const Model& model);
  RgbOf<T> reflectance(T cos_h) const;
  RgbOf<T> transmittance(T cos_h) const;
  Chances chances(T cos_o) const;
  // The chance that a sampled facet transmits.
  T transmission_chance(T cos_h) const;
  RgbOf<T> diffuse(T cos_o, T cos_i, T cos_d) const;
  T clearcoat_density(Vec3Of<T> h) const;
  Vec3Of<T> sample_clearcoat(Vec2Of<T> u) const;
  void add_clearcoat(Vec3Of<T> wo, Vec3Of<T> wi, Vec3Of<T> h, T chance, BsdfValueOf<T>& sum) const;
  BsdfValueOf<T> reflected(Vec3Of<T> wo, Vec3Of<T> wi, T diffuse_cos) const;
  BsdfValueOf<T> refracted_through_facets(Vec3Of<T> wo, Vec3Of<T> wi) const;
  BsdfValueOf<T> passed_through_sheet(Vec3Of<T> wo, Vec3Of<T> wi) const;
  BsdfValueOf<T> passed(Vec3Of<T> wo, Vec3Of<T> wi) const;
  BsdfValueOf<T> evaluate_turned(Vec3Of<T> wo, Vec3Of<T> wi, T diffuse_cos) const;
  Direction sample_sheet(Vec3Of<T> wo, Vec2Of<T> u) const;
  Direction sample_facets(Vec3Of<T> wo, Vec2Of<T> u, T u_side) const;
  Direction sample_direction(Vec3Of<T> wo, Vec2Of<T> u, T u_lobe) const;

  MaskOf<T> thin_{}, inside_{};  // inside_: inside of a solid
  T eta_{};                      // of the far side over the near side
  T roughness_{};
  MicrofacetsOf<T> facets_, sheet_facets_;  // sheet_facets_ transmit through a thin sheet
  // Weights of the lobes; inside of a solid all but dielectric_ and clear_ are 0.
  T dielectric_{}, metal_{}, tinted_{};  // of the reflectances of facets
  T clear_{}, diffuse_{}, diffuse_through_{}, flatness_{}, sheen_{}, clearcoat_{};
  RgbOf<T> base_color_, transmission_color_, tinted_f0_, sheen_color_;
  T clearcoat_alpha2_{}, clearcoat_norm_{};
  T diffuse_scale_ = T(1.0f);
  T tangent_x_ = T(1.0f), tangent_y_{};
};
extern template class DisneyBsdfOf<float>;
extern template class DisneyBsdfOf<FloatN>;

}  // namespace tessera::core::shading
