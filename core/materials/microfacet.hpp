// The GGX distribution of microfacet normals (Walter et al. 2007; Trowbridge and Reitz 1975) with Smith's
// masking, shared by the models that are made of microfacets. Directions are local, of unit length, +z being
// the surface's normal; `h` is a microfacet's normal with h.z >= 0.
#pragma once

#include "core/math/vec3.hpp"

namespace tessera::core {

// Rougher than this are all microfacets; smoother, floats cannot tell them from a smooth surface.
inline constexpr float kMinAlpha = 1e-3f;

class Ggx {
 public:
  // alpha in [kMinAlpha, 1]: half of the microfacets, by their projected area, are steeper than that.
  explicit Ggx(float alpha) : alpha_(alpha), alpha2_(alpha * alpha) {}

  float alpha() const { return alpha_; }

  // D: area of microfacets of normal h for each unit of surface and solid angle (Walter et al. 2007, eq. 33).
  float density(Vec3 h) const;

  // The share of microfacets facing `w` that is not masked (Walter et al. 2007, eq. 34). cos_w > 0.
  float visible(float cos_w) const { return 2 * cos_w / (cos_w + slant(cos_w)); }

  // The share seen from both directions, correlated by height, over 4 cos_o cos_i (Heitz 2014, eq. 99).
  float visible_from_both_over_4_cos(float cos_o, float cos_i) const {
    return 0.5f / (cos_i * slant(cos_o) + cos_o * slant(cos_i));
  }

  // Of the microfacets seen from `wo` (Heitz 2018). wo.z > 0; the density is per solid angle of h.
  Vec3 sample_visible(Vec3 wo, Vec2 u) const;
  float pdf_visible(Vec3 wo, Vec3 h) const;

  // Of all microfacets, by their projected area (Walter et al. 2007, eq. 35 and 36).
  Vec3 sample_projected(Vec2 u) const;
  float pdf_projected(Vec3 h) const { return density(h) * h.z; }

 private:
  // cos * sqrt(1 + alpha^2 tan^2), which is cos (1 + 2 lambda) in Smith's lambda.
  float slant(float cos_w) const;

  float alpha_, alpha2_;
};

}  // namespace tessera::core
