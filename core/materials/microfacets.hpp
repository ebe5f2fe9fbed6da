// SPDX-License-Identifier: Apache-2.0
// Distributions of microfacet normals other than GGX with height-correlated masking, which microfacet.hpp and
// anisotropic_ggx.hpp have: Beckmann's (Beckmann and Spizzichino 1963), and separable masking. A roughness
// for each of two tangents. Directions and `h` as in microfacet.hpp. T is float for one point, or FloatN for
// one in each lane. Stateless; thread-safe.
#pragma once

#include <cmath>

#include "core/math/simd_double.hpp"
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
template <typename T>
Vec3Of<T> at_cosine(T cosine) {
  using std::sqrt;
  return {sqrt(larger(T(0.0f), 1 - cosine * cosine)), T(0.0f), cosine};
}

template <typename T>
class MicrofacetsOf {
 public:
  MicrofacetsOf() = default;  // fully rough
  // Of the same kind in all lanes. Along x and along y, each in [kMinAlpha, 1].
  MicrofacetsOf(MicrofacetKind kind, T alpha_x, T alpha_y)
      : kind_(kind), alpha_x_(alpha_x), alpha_y_(alpha_y) {}
  MicrofacetsOf(MicrofacetKind kind, T alpha) : MicrofacetsOf(kind, alpha, alpha) {}

  MicrofacetKind kind() const { return kind_; }
  // The roughness of an isotropic surface with as many facets towards the normal.
  T mean_alpha() const {
    using std::sqrt;
    return sqrt(alpha_x_ * alpha_y_);
  }

  // D: microfacet area with normal h per unit of surface and solid angle (Walter et al. 2007, eq. 25 and 33).
  T density(Vec3Of<T> h) const;

  // G1: the unmasked fraction of the microfacets that face `w`. Requires w.z > 0.
  T visible(Vec3Of<T> w) const { return w.z / projected_area(w); }
  // G2 over 4 cos_o cos_i, for directions above the surface.
  T smith_visibility(Vec3Of<T> wo, Vec3Of<T> wi) const;

  // The normals visible from `wo`. Requires wo.z > 0; the density is per solid angle of h.
  Vec3Of<T> sample_visible(Vec3Of<T> wo, Vec2Of<T> u) const;
  T pdf_visible(Vec3Of<T> wo, Vec3Of<T> h) const {
    const T cos_oh = dot(wo, h);
    return select(cos_oh > 0, cos_oh * density(h) / projected_area(wo), T(0.0f));
  }

 private:
  // The area of the microfacets that face `w`, projected along it and per unit of surface, without masking:
  // w.z (1 + lambda) with Smith's lambda (Heitz 2014, eq. 72).
  T projected_area(Vec3Of<T> w) const;

  MicrofacetKind kind_;
  T alpha_x_ = T(1.0f), alpha_y_ = T(1.0f);
};
using Microfacets = MicrofacetsOf<float>;
extern template class MicrofacetsOf<float>;
extern template class MicrofacetsOf<FloatN>;

}  // namespace tessera::core
