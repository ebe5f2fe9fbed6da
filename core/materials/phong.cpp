#include "core/materials/phong.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/elementary.hpp"
#include "core/math/frame.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core {
namespace {

float power(float base, float exponent) {
  return static_cast<float>(pow(static_cast<double>(base), static_cast<double>(exponent)));
}

Vec3 mirrored(Vec3 wo) {
  return {-wo.x, -wo.y, wo.z};
}

// Around +z, density (n + 1) / (2 pi) cos^n per solid angle.
Vec3 sample_power_cosine(float n, Vec2 u) {
  const float cos_a = power(1 - u.x, 1 / (n + 1)), phi = 2 * kPi * u.y;
  const float sin_a = std::sqrt(std::max(0.0f, 1 - cos_a * cos_a));
  return {sin_a * cos(phi), sin_a * sin(phi), cos_a};
}

}  // namespace

float PhongBsdf::highlight_probability() const {
  const float kd = max_component(diffuse), ks = max_component(specular);
  return ks > 0 ? ks / (kd + ks) : 0;
}

float PhongBsdf::sampled_exponent() const {
  return lobe == PhongLobe::kNPlus1 ? exponent : exponent + 1;
}

BsdfValue PhongBsdf::evaluate(Vec3 wo, Vec3 wi) const {
  if (wo.z <= 0 || wi.z <= 0) return {};
  const float cos_a = std::clamp(dot(mirrored(wo), wi), 0.0f, 1.0f);
  const float to_n = power(cos_a, exponent);
  const float sampled = lobe == PhongLobe::kNPlus1 ? to_n : to_n * cos_a;
  const float p = highlight_probability();
  return {(diffuse / kPi + specular * ((exponent + 2) / (2 * kPi) * to_n)) * wi.z,
          p * (sampled_exponent() + 1) / (2 * kPi) * sampled + (1 - p) * pdf_cosine_hemisphere(wi.z)};
}

std::optional<BsdfSample> PhongBsdf::sample(Vec3 wo, Vec2 u, float u_lobe) const {
  if (wo.z <= 0) return std::nullopt;
  const bool highlight = u_lobe < highlight_probability();
  const Vec3 wi = highlight ? Frame::around(mirrored(wo)).to_world(sample_power_cosine(sampled_exponent(), u))
                            : sample_cosine_hemisphere(u);
  const BsdfValue value = evaluate(wo, wi);
  if (!(value.pdf > 0)) return std::nullopt;
  return weighed_sample(wi, value);
}

}  // namespace tessera::core
