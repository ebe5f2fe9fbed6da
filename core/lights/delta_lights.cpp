// SPDX-License-Identifier: Apache-2.0
#include "core/lights/delta_lights.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/math/elementary.hpp"

namespace tessera::core::lights {
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

PointLight::PointLight(Vec3 position, Rgb intensity, std::shared_ptr<const TextureImage> image,
                       const Transform& orientation)
    : position_(position),
      intensity_(intensity),
      mean_intensity_(mean(image ? intensity * image->mean() : intensity)),
      image_(std::move(image)),
      map_(0, orientation) {}

std::optional<LightSample> PointLight::sample(Vec3 p_lit) const {
  if (!image_) return sample_position(position_, intensity_, p_lit);
  const Rgb factor = image_->bilinear(map_.uv_of(p_lit - position_), Wrap::kRepeat, Wrap::kClamp);
  return sample_position(position_, intensity_ * factor, p_lit);
}

double PointLight::power() const {
  return 4 * std::numbers::pi * static_cast<double>(mean_intensity_);
}

LightBounds PointLight::bounds() const {
  return LightBounds({{position_, position_}}, NormalCone::all(), Falloff::cosine(),
                     static_cast<double>(mean_intensity_), false);
}

SpotLight::SpotLight(Vec3 position, Rgb intensity, const Cone& cone, const ProjectedImage& image,
                     Rgb image_mean)
    : position_(position),
      intensity_(intensity),
      axis_(cone.axis),
      mean_intensity_(mean(intensity * image_mean)),
      inner_angle_(cone.angle_degrees * (kPi / 360) * (1 - cone.softness)),
      outer_angle_(cone.angle_degrees * (kPi / 360)),
      falloff_(cone.falloff),
      image_(image) {
  outer_edge_ = one_minus_cos(outer_angle_);
  inner_edge_ = std::min(outer_edge_, one_minus_cos(inner_angle_));
  image_.right = image.right / length_squared(image.right);
  image_.up = image.up / length_squared(image.up);
}

float SpotLight::falloff(float off_axis) const {
  if (off_axis <= inner_edge_) return 1;
  if (off_axis >= outer_edge_) return 0;
  if (falloff_ == SpotFalloff::kLinear) {
    const float half = off_axis / 2, angle = 2 * atan2(std::sqrt(half), std::sqrt(1 - half));
    return std::clamp((outer_angle_ - angle) / (outer_angle_ - inner_angle_), 0.0f, 1.0f);
  }
  const float t = (outer_edge_ - off_axis) / (outer_edge_ - inner_edge_);
  return falloff_ == SpotFalloff::kSquared ? t * t : t * t * (3 - 2 * t);
}

// What the image does to the intensity in a unit direction of the cone.
Rgb SpotLight::projected(const std::vector<Texture>& textures, Vec3 direction) const {
  const float along = dot(direction, axis_);
  if (!(along > 0)) return {};
  const float a = dot(direction, image_.right) / along, b = dot(direction, image_.up) / along;
  if (!(std::fabs(a) <= 1 && std::fabs(b) <= 1)) return {};
  const Rgb color = textures[static_cast<std::size_t>(image_.texture)].evaluate({(1 + a) / 2, (1 + b) / 2});
  return image_.flat_field ? color / (along * along * along) : color;
}

std::optional<LightSample> SpotLight::sample(const std::vector<Texture>& textures, Vec3 p_lit) const {
  const Vec3 d = normalize(p_lit - position_);
  const float share = falloff(length_squared(d - axis_) / 2);
  if (image_.texture < 0 || share == 0) return sample_position(position_, intensity_ * share, p_lit);
  return sample_position(position_, intensity_ * projected(textures, d) * share, p_lit);
}

namespace {

// The integral of (outer - angle) / (outer - inner) over 1 - cos of the angle, from inner to outer, for a
// number of steps in the angle.
double linear_falloff_integral(double inner, double outer) {
  constexpr int kSteps = 64;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double t = (i + 0.5) / kSteps;
    sum += (1 - t) * static_cast<double>(sin(static_cast<float>(inner + t * (outer - inner))));
  }
  return sum * (outer - inner) / kSteps;
}

}  // namespace

// The mean over the falloff region is one half of the cubic, and a third of the square. Images count by their
// mean, as if they filled the cone.
double SpotLight::power() const {
  const double intensity = 2 * std::numbers::pi * static_cast<double>(mean_intensity_);
  if (falloff_ == SpotFalloff::kLinear)
    return intensity *
           (static_cast<double>(inner_edge_) +
            linear_falloff_integral(static_cast<double>(inner_angle_), static_cast<double>(outer_angle_)));
  const auto inner = static_cast<double>(inner_edge_), outer = static_cast<double>(outer_edge_);
  if (falloff_ == SpotFalloff::kSquared) return intensity * (inner + (outer - inner) / 3);
  return intensity * ((inner + outer) / 2);
}

// Treated as uniform up to its edge.
LightBounds SpotLight::bounds() const {
  constexpr float kNarrowest = 1e-5f;  // resolution of float cosines
  return LightBounds({{position_, position_}},
                     NormalCone::around(axis_, std::clamp(outer_edge_, kNarrowest, 1.0f)), Falloff::none(),
                     static_cast<double>(mean_intensity_), false);
}

std::optional<LightSample> DirectionalLight::sample() const {
  return LightSample{wi_, irradiance_, 1, true, std::nullopt};
}

double DirectionalLight::power(double scene_radius) const {
  return static_cast<double>(mean(irradiance_)) * std::numbers::pi * scene_radius * scene_radius;
}

}  // namespace tessera::core::lights
