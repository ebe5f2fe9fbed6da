// SPDX-License-Identifier: Apache-2.0
// Lights without extent: each is visible in at most one direction from any point, and rays cannot hit it.
#pragma once

#include <optional>

#include "core/lights/light_bounds.hpp"
#include "core/lights/light_sample.hpp"

namespace tessera::core {

// Emits uniformly in all directions.
class PointLight {
 public:
  // `intensity` in watts per steradian.
  PointLight(Vec3 position, Rgb intensity) : position_(position), intensity_(intensity) {}

  std::optional<LightSample> sample(Vec3 p_lit) const;
  double power() const;
  LightBounds bounds() const;

 private:
  Vec3 position_;
  Rgb intensity_;
};

// Emits into a cone: at full intensity near its axis, with a smooth falloff to zero at its edge.
class SpotLight {
 public:
  struct Cone {
    Vec3 axis;            // unit
    float angle_degrees;  // full angle, in (0, 180]
    float softness;       // the fraction of the angle, from the edge inwards, with falloff; in [0, 1]
  };
  SpotLight(Vec3 position, Rgb intensity, const Cone& cone);

  std::optional<LightSample> sample(Vec3 p_lit) const;
  double power() const;
  LightBounds bounds() const;

  // The fraction of the full intensity at an angle from the axis; `off_axis` is 1 - its cosine.
  float falloff(float off_axis) const;

 private:
  Vec3 position_;
  Rgb intensity_;
  Vec3 axis_;
  float inner_edge_, outer_edge_;  // 1 - cos of the angles where falloff begins and ends
};

// A light at infinity with parallel rays.
class DirectionalLight {
 public:
  // `direction`, unit, is the direction of travel; `irradiance` is that of a surface perpendicular to it.
  DirectionalLight(Vec3 direction, Rgb irradiance) : wi_(-direction), irradiance_(irradiance) {}

  std::optional<LightSample> sample() const;
  double power(double scene_radius) const;

  // Unit, opposite to the direction of travel.
  Vec3 wi() const { return wi_; }
  // Of a surface that faces the light, averaged over the channels.
  double irradiance() const { return static_cast<double>(mean(irradiance_)); }

 private:
  Vec3 wi_;
  Rgb irradiance_;
};

}  // namespace tessera::core
