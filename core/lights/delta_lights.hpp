// SPDX-License-Identifier: Apache-2.0
// Lights without extent: from any point they are seen in one direction or not at all, and no ray meets them.
#pragma once

#include <optional>

#include "core/lights/light_bounds.hpp"
#include "core/lights/light_sample.hpp"

namespace tessera::core {

// Shines alike in all directions.
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

// Shines into a cone: at full intensity near its axis, then falling off smoothly to nothing at its edge.
class SpotLight {
 public:
  struct Cone {
    Vec3 axis;            // unit
    float angle_degrees;  // from edge to edge, above 0 to 180
    float softness;       // the share of the angle, from the edge inwards, over which light falls off; 0 to 1
  };
  SpotLight(Vec3 position, Rgb intensity, const Cone& cone);

  std::optional<LightSample> sample(Vec3 p_lit) const;
  double power() const;
  LightBounds bounds() const;

  // The share of the full intensity at an angle from the axis; `off_axis` is 1 - its cosine.
  float falloff(float off_axis) const;

 private:
  Vec3 position_;
  Rgb intensity_;
  Vec3 axis_;
  float inner_edge_, outer_edge_;  // 1 - cos of the angles where light begins to fall off and where it ends
};

// Comes from infinitely far away, alike everywhere.
class DirectionalLight {
 public:
  // `direction`, unit, is the way that light travels; `irradiance` that of a surface which faces it.
  DirectionalLight(Vec3 direction, Rgb irradiance) : wi_(-direction), irradiance_(irradiance) {}

  std::optional<LightSample> sample() const;
  double power(double scene_radius) const;

  // Unit, against the way that light travels.
  Vec3 wi() const { return wi_; }
  // Of a surface that faces the light, the mean of the channels.
  double irradiance() const { return static_cast<double>(mean(irradiance_)); }

 private:
  Vec3 wi_;
  Rgb irradiance_;
};

}  // namespace tessera::core
