// SPDX-License-Identifier: Apache-2.0
#include "core/lights/delta_lights.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/math/elementary.hpp"

namespace tessera::core {
namespace {

// A sample of a light at an exactly known position.
std::optional<LightSample> sample_position(Vec3 position, Rgb intensity, Vec3 p_lit) {
  const Vec3 d = position - p_lit;
  const float distance2 = length_squared(d);
  const Rgb irradiance = intensity / distance2;
  if (is_black(irradiance) || !is_finite(irradiance)) return std::nullopt;
  LightSample sample{normalize(d), irradiance, 1, true, SurfacePoint{}};
  sample.point->position = position;
  return sample;
}

// 1 - cos without cancellation for small angles.
float one_minus_cos(float angle) {
  const float half_sine = sin(angle / 2);
  return 2 * half_sine * half_sine;
}

}  // namespace

std::optional<LightSample> PointLight::sample(Vec3 p_lit) const {
  return sample_position(position_, intensity_, p_lit);
}

double PointLight::power() const {
  return 4 * std::numbers::pi * static_cast<double>(mean(intensity_));
}

LightBounds PointLight::bounds() const {
  return LightBounds({{position_, position_}}, NormalCone::all(), Falloff::cosine(),
                     static_cast<double>(mean(intensity_)), false);
}

SpotLight::SpotLight(Vec3 position, Rgb intensity, const Cone& cone)
    : position_(position), intensity_(intensity), axis_(cone.axis) {
  const float outer = cone.angle_degrees * (kPi / 360);
  outer_edge_ = one_minus_cos(outer);
  inner_edge_ = std::min(outer_edge_, one_minus_cos(outer * (1 - cone.softness)));
}

// A cubic in the cosine, with slope 0 at both ends.
float SpotLight::falloff(float off_axis) const {
  if (off_axis <= inner_edge_) return 1;
  if (off_axis >= outer_edge_) return 0;
  const float t = (outer_edge_ - off_axis) / (outer_edge_ - inner_edge_);
  return t * t * (3 - 2 * t);
}

std::optional<LightSample> SpotLight::sample(Vec3 p_lit) const {
  const Vec3 d = p_lit - position_;
  return sample_position(position_, intensity_ * falloff(length_squared(normalize(d) - axis_) / 2), p_lit);
}

// The mean of the cubic over the falloff region is one half.
double SpotLight::power() const {
  const double mean_edge = (static_cast<double>(inner_edge_) + static_cast<double>(outer_edge_)) / 2;
  return 2 * std::numbers::pi * static_cast<double>(mean(intensity_)) * mean_edge;
}

// Treated as uniform up to its edge.
LightBounds SpotLight::bounds() const {
  constexpr float kNarrowest = 1e-5f;  // resolution of float cosines
  return LightBounds({{position_, position_}},
                     NormalCone::around(axis_, std::clamp(outer_edge_, kNarrowest, 1.0f)), Falloff::none(),
                     static_cast<double>(mean(intensity_)), false);
}

std::optional<LightSample> DirectionalLight::sample() const {
  return LightSample{wi_, irradiance_, 1, true, std::nullopt};
}

double DirectionalLight::power(double scene_radius) const {
  return static_cast<double>(mean(irradiance_)) * std::numbers::pi * scene_radius * scene_radius;
}

}  // namespace tessera::core
