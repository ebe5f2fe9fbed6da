// SPDX-License-Identifier: Apache-2.0
// The GGX distribution of microfacet normals with a roughness for each of two tangents (Heitz 2014, eq. 85
// and 86). Directions and `h` as in microfacet.hpp. T is float for one point, or FloatN for one in each lane.
#pragma once

#include <cmath>

#include "core/materials/visible_hemisphere.hpp"
#include "core/math/elementary.hpp"
#include "core/math/vec3.hpp"

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
    return 0.5f / (wi.z * stretched_length(wo) + wo.z * stretched_length(wi));
  }

  // The normals visible from `wo` (Heitz 2018). Requires wo.z > 0; the density is per solid angle of h.
  Vec3Of<T> sample_visible(Vec3Of<T> wo, Vec2Of<T> u) const;
  T pdf_visible(Vec3Of<T> wo, Vec3Of<T> h) const {
    return 2 * larger(T(0.0f), dot(wo, h)) * density(h) / (wo.z + stretched_length(wo));
  }

 private:
  // cos (1 + 2 lambda) with Smith's lambda.
  T stretched_length(Vec3Of<T> w) const {
    using std::sqrt;
    const T x = alpha_x_ * w.x, y = alpha_y_ * w.y;
    return sqrt(x * x + y * y + w.z * w.z);
  }

  T alpha_x_ = 1.0f, alpha_y_ = 1.0f;
};
using AnisotropicGgx = AnisotropicGgxOf<float>;

template <typename T>
Vec3Of<T> AnisotropicGgxOf<T>::sample_visible(Vec3Of<T> wo, Vec2Of<T> u) const {
  const Vec3Of<T> n =
      sample_visible_hemisphere(normalize(Vec3Of<T>{alpha_x_ * wo.x, alpha_y_ * wo.y, wo.z}), u);
  return normalize(Vec3Of<T>{alpha_x_ * n.x, alpha_y_ * n.y, larger(T(1e-6f), n.z)});
}

}  // namespace tessera::core
