// SPDX-License-Identifier: Apache-2.0
// The GGX distribution of microfacet normals (Walter et al. 2007; Trowbridge and Reitz 1975) with Smith
// masking, shared by the microfacet models. Directions are local unit vectors with +z the surface normal;
// `h` is a microfacet's normal with h.z >= 0.
#pragma once

#include <cmath>

#include "core/materials/visible_hemisphere.hpp"
#include "core/math/elementary.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

// The minimum alpha of microfacet surfaces; smoother ones are numerically indistinguishable from a smooth
// surface.
inline constexpr float kMinAlpha = 1e-3f;

// T is float for one point, or FloatN for one in each lane.
template <typename T>
class GgxOf {
 public:
  GgxOf() : GgxOf(T(1.0f)) {}
  // alpha is in [kMinAlpha, 1]. Half of the microfacets, by projected area, have a slope above alpha.
  explicit GgxOf(T alpha) : alpha_(alpha), alpha2_(alpha * alpha) {}

  T alpha() const { return alpha_; }

  // D: microfacet area with normal h per unit of surface and solid angle (Walter et al. 2007, eq. 33).
  T density(Vec3Of<T> h) const {
    // cos^4 (1 + tan^2 / alpha^2)^2, without cancellation for small alpha.
    const T stretched = (h.x * h.x + h.y * h.y) / alpha2_ + h.z * h.z;
    return 1 / (kPi * alpha2_ * stretched * stretched);
  }

  // G1: the unmasked fraction of the microfacets that face `w` (Walter et al. 2007, eq. 34). Requires cos_w
  // > 0.
  T visible(T cos_w) const { return 2 * cos_w / (cos_w + stretched_length(cos_w)); }

  // Height-correlated Smith G2 over 4 cos_o cos_i (Heitz 2014, eq. 99).
  T smith_visibility(T cos_o, T cos_i) const {
    return 0.5f / (cos_i * stretched_length(cos_o) + cos_o * stretched_length(cos_i));
  }

  // Samples the normals visible from `wo` (Heitz 2018). Requires wo.z > 0; the density is per solid angle
  // of h.
  Vec3Of<T> sample_visible(Vec3Of<T> wo, Vec2Of<T> u) const;
  T pdf_visible(Vec3Of<T> wo, Vec3Of<T> h) const {
    return 2 * larger(T(0.0f), dot(wo, h)) * density(h) / (wo.z + stretched_length(wo.z));
  }

  // Samples all normals in proportion to their projected area (Walter et al. 2007, eq. 35 and 36).
  Vec3Of<T> sample_projected(Vec2Of<T> u) const;
  T pdf_projected(Vec3Of<T> h) const { return density(h) * h.z; }

 private:
  // cos * sqrt(1 + alpha^2 tan^2), which is cos (1 + 2 lambda) with Smith's lambda.
  T stretched_length(T cos_w) const {
    using std::sqrt;
    return sqrt(alpha2_ + (1 - alpha2_) * cos_w * cos_w);
  }

  T alpha_, alpha2_;
};
using Ggx = GgxOf<float>;

template <typename T>
Vec3Of<T> GgxOf<T>::sample_visible(Vec3Of<T> wo, Vec2Of<T> u) const {
  const Vec3Of<T> n = sample_visible_hemisphere(normalize(Vec3Of<T>{alpha_ * wo.x, alpha_ * wo.y, wo.z}), u);
  return normalize(Vec3Of<T>{alpha_ * n.x, alpha_ * n.y, larger(T(1e-6f), n.z)});
}

template <typename T>
Vec3Of<T> GgxOf<T>::sample_projected(Vec2Of<T> u) const {
  using std::sqrt;
  const T scale = 1 / (1 + (alpha2_ - 1) * u.x), cos2 = (1 - u.x) * scale;
  const T sin_h = sqrt(alpha2_ * u.x * scale);
  const auto [s, c] = sin_cos_turns(u.y);
  return {sin_h * c, sin_h * s, sqrt(cos2)};
}

}  // namespace tessera::core
