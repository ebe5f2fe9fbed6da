#include "core/materials/microfacet.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/elementary.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core {

float Ggx::slant(float cos_w) const {
  return std::sqrt(alpha2_ + (1 - alpha2_) * cos_w * cos_w);
}

float Ggx::density(Vec3 h) const {
  // cos^4 (1 + tan^2 / alpha^2)^2, which does not cancel where alpha is small.
  const float stretched = (h.x * h.x + h.y * h.y) / alpha2_ + h.z * h.z;
  return 1 / (kPi * alpha2_ * stretched * stretched);
}

Vec3 Ggx::sample_visible(Vec3 wo, Vec2 u) const {
  const Vec3 stretched = normalize({alpha_ * wo.x, alpha_ * wo.y, wo.z});
  const float across2 = stretched.x * stretched.x + stretched.y * stretched.y;
  const Vec3 t1 = across2 > 0 ? Vec3{-stretched.y, stretched.x, 0} / std::sqrt(across2) : Vec3{1, 0, 0};
  const Vec3 t2 = cross(stretched, t1);
  // The hemisphere's projection onto the plane across `stretched`: a half disk and a half ellipse.
  const Vec2 p = sample_disk(u);
  const float share = 0.5f * (1 + stretched.z);
  const float p2 = (1 - share) * std::sqrt(std::max(0.0f, 1 - p.x * p.x)) + share * p.y;
  const Vec3 n = t1 * p.x + t2 * p2 + stretched * std::sqrt(std::max(0.0f, 1 - p.x * p.x - p2 * p2));
  return normalize({alpha_ * n.x, alpha_ * n.y, std::max(1e-6f, n.z)});
}

float Ggx::pdf_visible(Vec3 wo, Vec3 h) const {
  return 2 * std::max(0.0f, dot(wo, h)) * density(h) / (wo.z + slant(wo.z));
}

Vec3 Ggx::sample_projected(Vec2 u) const {
  const float scale = 1 / (1 + (alpha2_ - 1) * u.x), cos2 = (1 - u.x) * scale;
  const float sin_h = std::sqrt(alpha2_ * u.x * scale);
  const auto [s, c] = sin_cos_turns(u.y);
  return {sin_h * c, sin_h * s, std::sqrt(cos2)};
}

}  // namespace tessera::core
