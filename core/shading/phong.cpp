// SPDX-License-Identifier: Apache-2.0
#include "core/shading/phong.hpp"

#include <cmath>

#include "core/math/elementary.hpp"
#include "core/math/frame.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core::shading {
namespace {

template <typename T>
Vec3Of<T> mirror_image(Vec3Of<T> wo) {
  return {-wo.x, -wo.y, wo.z};
}

// The polar angle of a sample around +z with density (n + 1) / (2 pi) cos^n per solid angle. This and the
// cosine below are in double precision, because high powers matter only near a cosine of 1.
template <typename T>
SinCosOf<T> sampled_angle(T n, T u) {
  using std::sqrt;
  const WideOf<T> cos_a = pow(1 - widened(u), 1 / (widened(n) + 1));
  return {to_float(sqrt((1 - cos_a) * (1 + cos_a))), to_float(cos_a)};
}

template <typename T>
Vec3Of<T> sample_power_cosine(T n, Vec2Of<T> u) {
  const auto [sin_a, cos_a] = sampled_angle(n, u.x);
  const auto [s, c] = sin_cos_turns(u.y);
  return {sin_a * c, sin_a * s, cos_a};
}

// cos^n of the angle between unit vectors, computed from the chord; 0 beyond a right angle, and where it
// is not `wanted`.
template <typename T>
T power_cosine(Vec3Of<T> a, Vec3Of<T> b, T n, T wanted) {
  const WideOf<T> cos_a = 1 - widened(length_squared(a - b)) / 2;
  const MaskOf<T> lit = (wanted > 0) & (cos_a > 0);
  return any(lit) ? select(lit, to_float(pow(cos_a, widened(n))), T(0.0f)) : T(0.0f);
}

}  // namespace

template <typename T>
T PhongBsdfOf<T>::highlight_probability() const {
  const T kd = max_component(diffuse), ks = max_component(specular);
  return select(ks > 0, ks / (kd + ks), T(0.0f));
}

template <typename T>
T PhongBsdfOf<T>::sampled_exponent() const {
  return select(n_plus_2, exponent + 1, exponent);
}

template <typename T>
BsdfValueOf<T> PhongBsdfOf<T>::evaluate(Vec3Of<T> wo, Vec3Of<T> wi, T diffuse_cos) const {
  const MaskOf<T> dark = (wo.z <= 0) | (wi.z <= 0);
  const Vec3Of<T> mirrored_wo = mirror_image(wo);
  const T to_n = power_cosine(mirrored_wo, wi, exponent, max_component(specular));
  const T sampled = select(n_plus_2, to_n * dot(mirrored_wo, wi), to_n);
  const T p = highlight_probability();
  const RgbOf<T> value =
      diffuse * (diffuse_cos / kPi) + specular * ((exponent + 2) / (2 * kPi) * to_n * wi.z);
  const T pdf =
      p * (sampled_exponent() + 1) / (2 * kPi) * sampled + (1 - p) * sampling::pdf_cosine_hemisphere(wi.z);
  return {select(dark, RgbOf<T>{}, value), select(dark, T(0.0f), pdf)};
}

template <typename T>
BsdfSampleOf<T> PhongBsdfOf<T>::sample(Vec3Of<T> wo, Vec2Of<T> u, T u_lobe) const {
  const MaskOf<T> highlight = u_lobe < highlight_probability();
  Vec3Of<T> wi = sampling::sample_cosine_hemisphere(u);
  if (any(highlight)) {
    const Vec3Of<T> around = sample_power_cosine(sampled_exponent(), u);
    wi = select(highlight, FrameOf<T>::around(mirror_image(wo)).to_world(around), wi);
  }
  const BsdfValueOf<T> value = evaluate(wo, wi, wi.z);
  const MaskOf<T> found = (wo.z > 0) & (value.pdf > 0);
  return {found, false, false, wi, value.value / value.pdf, value.pdf, T(1.0f)};
}

template struct PhongBsdfOf<float>;
template struct PhongBsdfOf<FloatN>;

}  // namespace tessera::core::shading
