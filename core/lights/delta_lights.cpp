#include "core/lights/delta_lights.hpp"

#include <algorithm>
#include <cmath>

#include "core/math/elementary.hpp"

namespace tessera::core {
namespace {

constexpr double kPiDouble = 3.14159265358979323846;

// From a position that is known exactly.
std::optional<LightSample> sample_position(Vec3 position, Rgb intensity, Vec3 p_lit) {
  const Vec3 d = position - p_lit;
  const float distance2 = length_squared(d);
  const Rgb irradiance = intensity / distance2;
  if (is_black(irradiance) || !is_finite(irradiance)) return std::nullopt;
  LightSample sample{normalize(d), irradiance, 1, true, SurfacePoint{}};
  sample.point->position = position;
  return sample;
}

}  // namespace

std::optional<LightSample> PointLight::sample(Vec3 p_lit) const {
  return sample_position(position_, intensity_, p_lit);
}

double PointLight::power() const {
  return 4 * kPiDouble * static_cast<double>(luminance(intensity_));
}

SpotLight::SpotLight(Vec3 position, Rgb intensity, const Cone& cone)
    : position_(position), intensity_(intensity), axis_(cone.axis) {
  const float outer = cone.angle_degrees * (kPi / 360);
  cos_outer_ = cos(outer);
  cos_inner_ = std::max(cos_outer_, cos(outer * (1 - cone.softness)));
}

// A cubic in the cosine, with slope 0 at both ends.
float SpotLight::falloff(float cos_theta) const {
  if (cos_theta >= cos_inner_) return 1;
  if (cos_theta <= cos_outer_) return 0;
  const float t = (cos_theta - cos_outer_) / (cos_inner_ - cos_outer_);
  return t * t * (3 - 2 * t);
}

std::optional<LightSample> SpotLight::sample(Vec3 p_lit) const {
  const Vec3 d = p_lit - position_;
  return sample_position(position_, intensity_ * falloff(dot(d, axis_) / length(d)), p_lit);
}

// The cubic's mean over the falloff is one half.
double SpotLight::power() const {
  const double mean_edge = (static_cast<double>(cos_inner_) + static_cast<double>(cos_outer_)) / 2;
  return 2 * kPiDouble * static_cast<double>(luminance(intensity_)) * (1 - mean_edge);
}

std::optional<LightSample> DirectionalLight::sample() const {
  return LightSample{wi_, irradiance_, 1, true, std::nullopt};
}

double DirectionalLight::power(double scene_radius) const {
  return static_cast<double>(luminance(irradiance_)) * kPiDouble * scene_radius * scene_radius;
}

}  // namespace tessera::core
