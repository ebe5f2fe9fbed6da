// SPDX-License-Identifier: Apache-2.0
// The GGX distribution of microfacet normals with a roughness for each of two tangents (Heitz 2014, eq. 85
// and 86). Directions and `h` as in microfacet.hpp.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/math/elementary.hpp"
#include "core/math/vec3.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core {

class AnisotropicGgx {
 public:
  // Along x and along y, each in [kMinAlpha, 1].
  AnisotropicGgx(float alpha_x, float alpha_y) : alpha_x_(alpha_x), alpha_y_(alpha_y) {}

  // The roughness of an isotropic surface with as many facets towards the normal.
  float mean_alpha() const { return std::sqrt(alpha_x_ * alpha_y_); }
  bool is_isotropic() const { return alpha_x_ == alpha_y_; }

  // D: microfacet area with normal h per unit of surface and solid angle.
  float density(Vec3 h) const {
    const float x = h.x / alpha_x_, y = h.y / alpha_y_;
    const float stretched = x * x + y * y + h.z * h.z;
    return 1 / (kPi * alpha_x_ * alpha_y_ * stretched * stretched);
  }

  // Height-correlated Smith G2 over 4 cos_o cos_i (Heitz 2014, eq. 99), for directions above the surface.
  float smith_visibility(Vec3 wo, Vec3 wi) const { return 0.5f / (wi.z * slant(wo) + wo.z * slant(wi)); }

  // The normals visible from `wo` (Heitz 2018). Requires wo.z > 0; the density is per solid angle of h.
  Vec3 sample_visible(Vec3 wo, Vec2 u) const {
    const Vec3 stretched = normalize(Vec3{alpha_x_ * wo.x, alpha_y_ * wo.y, wo.z});
    const float across2 = stretched.x * stretched.x + stretched.y * stretched.y;
    const Vec3 t1 = across2 > 0 ? Vec3{-stretched.y, stretched.x, 0} / std::sqrt(across2) : Vec3{1, 0, 0};
    const Vec3 t2 = cross(stretched, t1);
    const Vec2 p = sample_disk(u);
    const float share = 0.5f * (1 + stretched.z);
    const float p2 = (1 - share) * std::sqrt(std::max(0.0f, 1 - p.x * p.x)) + share * p.y;
    const Vec3 n = t1 * p.x + t2 * p2 + stretched * std::sqrt(std::max(0.0f, 1 - p.x * p.x - p2 * p2));
    return normalize(Vec3{alpha_x_ * n.x, alpha_y_ * n.y, std::max(1e-6f, n.z)});
  }
  float pdf_visible(Vec3 wo, Vec3 h) const {
    return 2 * std::max(0.0f, dot(wo, h)) * density(h) / (wo.z + slant(wo));
  }

 private:
  // cos (1 + 2 lambda) with Smith's lambda.
  float slant(Vec3 w) const {
    const float x = alpha_x_ * w.x, y = alpha_y_ * w.y;
    return std::sqrt(x * x + y * y + w.z * w.z);
  }

  float alpha_x_, alpha_y_;
};

}  // namespace tessera::core
