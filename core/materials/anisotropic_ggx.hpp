// SPDX-License-Identifier: Apache-2.0
// The GGX distribution of microfacet normals with a roughness for each of two tangents (Heitz 2014, eq. 85
// and 86). Directions and `h` as in microfacet.hpp. T is float for one point, or Float8 for one in each lane.
#pragma once

#include <cmath>

#include "core/math/elementary.hpp"
#include "core/math/vec3.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core {

template <typename T>
class AnisotropicGgxOf {
 public:
  AnisotropicGgxOf() = default;  // fully rough
  // Along x and along y, each in [kMinAlpha, 1].
  AnisotropicGgxOf(T alpha_x, T alpha_y) : alpha_x_(alpha_x), alpha_y_(alpha_y) {}

  T alpha_x() const { return alpha_x_; }
  T alpha_y() const { return alpha_y_; }
  // The roughness of an isotropic surface with as many facets towards the normal.
  T mean_alpha() const {
    using std::sqrt;
    return sqrt(alpha_x_ * alpha_y_);
  }

  // D: microfacet area with normal h per unit of surface and solid angle.
  T density(Vec3Of<T> h) const {
    const T x = h.x / alpha_x_, y = h.y / alpha_y_;
    const T stretched = x * x + y * y + h.z * h.z;
    return 1 / (kPi * alpha_x_ * alpha_y_ * stretched * stretched);
  }

  // Height-correlated Smith G2 over 4 cos_o cos_i (Heitz 2014, eq. 99), for directions above the surface.
  T smith_visibility(Vec3Of<T> wo, Vec3Of<T> wi) const {
    return 0.5f / (wi.z * slant(wo) + wo.z * slant(wi));
  }

  // The normals visible from `wo` (Heitz 2018). Requires wo.z > 0; the density is per solid angle of h.
  Vec3Of<T> sample_visible(Vec3Of<T> wo, Vec2Of<T> u) const;
  T pdf_visible(Vec3Of<T> wo, Vec3Of<T> h) const {
    return 2 * larger(T(0.0f), dot(wo, h)) * density(h) / (wo.z + slant(wo));
  }

 private:
  // cos (1 + 2 lambda) with Smith's lambda.
  T slant(Vec3Of<T> w) const {
    using std::sqrt;
    const T x = alpha_x_ * w.x, y = alpha_y_ * w.y;
    return sqrt(x * x + y * y + w.z * w.z);
  }

  T alpha_x_ = 1.0f, alpha_y_ = 1.0f;
};
using AnisotropicGgx = AnisotropicGgxOf<float>;

template <typename T>
Vec3Of<T> AnisotropicGgxOf<T>::sample_visible(Vec3Of<T> wo, Vec2Of<T> u) const {
  using std::sqrt;
  const Vec3Of<T> stretched = normalize(Vec3Of<T>{alpha_x_ * wo.x, alpha_y_ * wo.y, wo.z});
  const T across2 = stretched.x * stretched.x + stretched.y * stretched.y;
  const Vec3Of<T> t1 =
      select(across2 > 0, Vec3Of<T>{-stretched.y, stretched.x, 0} / sqrt(across2), Vec3Of<T>{1, 0, 0});
  const Vec3Of<T> t2 = cross(stretched, t1);
  const Vec2Of<T> p = sample_disk(u);
  const T share = 0.5f * (1 + stretched.z);
  const T p2 = (1 - share) * sqrt(larger(T(0.0f), 1 - p.x * p.x)) + share * p.y;
  const Vec3Of<T> n = t1 * p.x + t2 * p2 + stretched * sqrt(larger(T(0.0f), 1 - p.x * p.x - p2 * p2));
  return normalize(Vec3Of<T>{alpha_x_ * n.x, alpha_y_ * n.y, larger(T(1e-6f), n.z)});
}

}  // namespace tessera::core
