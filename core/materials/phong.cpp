// SPDX-License-Identifier: Apache-2.0
#include "core/materials/phong.hpp"

#include <cmath>

#include "core/math/elementary.hpp"
#include "core/math/frame.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core {
namespace {

Vec3 mirrored(Vec3 wo) {
  return {-wo.x, -wo.y, wo.z};
}

// Samples around +z with density (n + 1) / (2 pi) cos^n per solid angle. This and the cosine below are in
// double precision, because high powers matter only near a cosine of 1.
Vec3 sample_power_cosine(float n, Vec2 u) {
  const double cos_a = pow(1 - static_cast<double>(u.x), 1 / (static_cast<double>(n) + 1));
  const auto sin_a = static_cast<float>(std::sqrt((1 - cos_a) * (1 + cos_a)));
  const auto [s, c] = sin_cos_turns(u.y);
  return {sin_a * c, sin_a * s, static_cast<float>(cos_a)};
}

// cos^n of the angle between unit vectors, computed from the chord; 0 beyond a right angle.
float power_cosine(Vec3 a, Vec3 b, float n) {
  const double cos_a = 1 - static_cast<double>(length_squared(a - b)) / 2;
  return cos_a > 0 ? static_cast<float>(pow(cos_a, static_cast<double>(n))) : 0;
}

}  // namespace

float PhongBsdf::highlight_probability() const {
  const float kd = max_component(diffuse), ks = max_component(specular);
  return ks > 0 ? ks / (kd + ks) : 0;
}

float PhongBsdf::sampled_exponent() const {
  return lobe == PhongLobe::kNPlus1 ? exponent : exponent + 1;
}

BsdfValue PhongBsdf::evaluate(Vec3 wo, Vec3 wi, float diffuse_cos) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  const float to_n = power_cosine(mirrored(wo), wi, exponent);
  const float sampled = lobe == PhongLobe::kNPlus1 ? to_n : to_n * dot(mirrored(wo), wi);
  const float p = highlight_probability();
  return {diffuse * (diffuse_cos / kPi) + specular * ((exponent + 2) / (2 * kPi) * to_n * wi.z),
          p * (sampled_exponent() + 1) / (2 * kPi) * sampled + (1 - p) * pdf_cosine_hemisphere(wi.z)};
}

std::optional<BsdfSample> PhongBsdf::sample(Vec3 wo, Vec2 u, float u_lobe) const {
  if (wo.z <= 0) return std::nullopt;
  const bool highlight = u_lobe < highlight_probability();
  const Vec3 wi = highlight ? Frame::around(mirrored(wo)).to_world(sample_power_cosine(sampled_exponent(), u))
                            : sample_cosine_hemisphere(u);
  const BsdfValue value = evaluate(wo, wi, wi.z);
  if (!(value.pdf > 0)) return std::nullopt;
  return weighed_sample(wi, value);
}

}  // namespace tessera::core
