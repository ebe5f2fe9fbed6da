// SPDX-License-Identifier: Apache-2.0
// Distributions of microfacet normals other than GGX with height-correlated masking, which microfacet.hpp and
// anisotropic_ggx.hpp have: Beckmann's (Beckmann and Spizzichino 1963), and separable masking. A roughness
// for each of two tangents. Directions and `h` as in microfacet.hpp. Stateless; thread-safe.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/math/vec3.hpp"

namespace tessera::core {

enum class MicrofacetDistribution { kGgx, kBeckmann };

// Smith's masking and shadowing for two directions.
enum class SmithMasking {
  kCorrelated,  // by the height of the microfacet (Heitz 2014, eq. 99)
  kSeparable,   // the product of both (Walter et al. 2007, eq. 23)
};

struct MicrofacetKind {
  MicrofacetDistribution distribution = MicrofacetDistribution::kGgx;
  SmithMasking masking = SmithMasking::kCorrelated;

  // Whether it is that of Ggx and AnisotropicGgx, which are faster.
  bool is_correlated_ggx() const {
    return distribution == MicrofacetDistribution::kGgx && masking == SmithMasking::kCorrelated;
  }
};

// A direction at this cosine to the normal, for isotropic microfacets.
inline Vec3 at_cosine(float cosine) {
  return {std::sqrt(std::max(0.0f, 1 - cosine * cosine)), 0, cosine};
}

class Microfacets {
 public:
  Microfacets() = default;  // fully rough
  // Along x and along y, each in [kMinAlpha, 1].
  Microfacets(MicrofacetKind kind, float alpha_x, float alpha_y)
      : kind_(kind), alpha_x_(alpha_x), alpha_y_(alpha_y) {}
  Microfacets(MicrofacetKind kind, float alpha) : Microfacets(kind, alpha, alpha) {}

  MicrofacetKind kind() const { return kind_; }
  // The roughness of an isotropic surface with as many facets towards the normal.
  float mean_alpha() const { return std::sqrt(alpha_x_ * alpha_y_); }

  // D: microfacet area with normal h per unit of surface and solid angle (Walter et al. 2007, eq. 25 and 33).
  float density(Vec3 h) const;

  // G1: the unmasked fraction of the microfacets that face `w`. Requires w.z > 0.
  float visible(Vec3 w) const { return w.z / projected_area(w); }
  // G2 over 4 cos_o cos_i, for directions above the surface.
  float smith_visibility(Vec3 wo, Vec3 wi) const;

  // The normals visible from `wo`. Requires wo.z > 0; the density is per solid angle of h.
  Vec3 sample_visible(Vec3 wo, Vec2 u) const;
  float pdf_visible(Vec3 wo, Vec3 h) const {
    const float cos_oh = dot(wo, h);
    return cos_oh > 0 ? cos_oh * density(h) / projected_area(wo) : 0;
  }

 private:
  // The area of the microfacets that face `w`, projected along it and per unit of surface, without masking:
  // w.z (1 + lambda) with Smith's lambda (Heitz 2014, eq. 72).
  float projected_area(Vec3 w) const;

  MicrofacetKind kind_;
  float alpha_x_ = 1, alpha_y_ = 1;
};

}  // namespace tessera::core
