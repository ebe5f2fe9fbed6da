// SPDX-License-Identifier: Apache-2.0
// Disney's principled BSDF (Burley 2012, 2015): GGX reflection of a dielectric or a metal, with transmission,
// a clearcoat of the GTR1 distribution, and diffuse reflection with retro-reflection and sheen. The thin
// sheet is that of Burley 2015, section 5.3. Masking is separable.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/materials/bsdf_sample.hpp"
#include "core/materials/disney.hpp"
#include "core/materials/microfacets.hpp"

namespace tessera::core {

class DisneyBsdf {
 public:
  // Directions are those of bsdf.hpp. `outside` and `tint` as there.
  DisneyBsdf(const Disney& model, const std::vector<Texture>& textures, const UvSets& uv, bool outside,
             Rgb tint);

  void orient(Vec3 tangent_local);
  bool is_delta() const { return false; }
  bool transmits() const { return clear_ > 0 || diffuse_through_ > 0; }
  void scale_diffuse(float factor) { diffuse_scale_ *= factor; }
  BsdfValue evaluate(Vec3 wo_local, Vec3 wi_local, float diffuse_cos) const;
  std::optional<BsdfSample> sample(Vec3 wo_local, Vec2 u, float u_lobe) const;

  // The index of refraction on the far side over the near side.
  float transmitted_eta() const { return thin_ ? 1 : eta_; }

 private:
  enum Lobe { kFacets, kClearcoat, kDiffuse, kThrough };  // kThrough: diffuse transmission
  using Chances = std::array<float, 4>;

  void set_facets(float roughness, float anisotropic, float ior);
  void set_colors(float specular_tint, float sheen_tint, float ior);
  Rgb reflectance(float cos_h) const;
  Rgb transmittance(float cos_h) const;
  Chances chances(float cos_o) const;
  // The chance that a sampled facet transmits.
  float transmission_chance(float cos_h) const;
  Rgb diffuse(float cos_o, float cos_i, float cos_d) const;
  float clearcoat_density(Vec3 h) const;
  Vec3 sample_clearcoat(Vec2 u) const;
  BsdfValue reflected(Vec3 wo, Vec3 wi, float diffuse_cos) const;
  BsdfValue refracted_through_facets(Vec3 wo, Vec3 wi) const;
  BsdfValue passed_through_sheet(Vec3 wo, Vec3 wi) const;
  BsdfValue evaluate_turned(Vec3 wo, Vec3 wi, float diffuse_cos) const;
  std::optional<Vec3> sample_facets(Vec3 wo, Vec2 u, float u_side) const;

  bool thin_;
  float eta_;  // of the far side over the near side
  float roughness_;
  Microfacets facets_, sheet_facets_;  // sheet_facets_ transmit through a thin sheet
  // Weights of the lobes; inside of a solid all but dielectric_ and clear_ are 0.
  float dielectric_, metal_ = 0, tinted_ = 0;  // of the reflectances of facets
  float clear_ = 0, diffuse_ = 0, diffuse_through_ = 0, flatness_ = 0, sheen_ = 0, clearcoat_ = 0;
  Rgb base_color_, transmission_color_, tinted_f0_, sheen_color_;
  float clearcoat_alpha2_ = 0, clearcoat_norm_ = 0;
  float diffuse_scale_ = 1;
  Vec2 tangent_{1, 0};
};

}  // namespace tessera::core
