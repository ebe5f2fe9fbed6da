// SPDX-License-Identifier: Apache-2.0
// Lights without extent: each is visible in at most one direction from any point, and rays cannot hit it.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/lights/equirectangular.hpp"
#include "core/lights/light_bounds.hpp"
#include "core/lights/light_sample.hpp"
#include "core/lights/spot_description.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core::lights {

// Emits in all directions: uniformly, or as an equirectangular image says.
class PointLight {
 public:
  // `intensity` in watts per steradian. `image`, which may be null, multiplies it; `orientation` as
  // EquirectangularMap's.
  PointLight(Vec3 position, Rgb intensity, std::shared_ptr<const TextureImage> image = nullptr,
             const Transform& orientation = {});

  std::optional<LightSample> sample(Vec3 p_lit) const;
  double power() const;
  LightBounds bounds() const;

 private:
  Vec3 position_;
  Rgb intensity_;
  float mean_intensity_;  // over all directions and channels
  std::shared_ptr<const TextureImage> image_;
  EquirectangularMap map_;
};

// Emits into a cone: at full intensity near its axis, with a falloff to zero at its edge; or an image within
// it.
class SpotLight {
 public:
  struct Cone {
    Vec3 axis;            // unit
    float angle_degrees;  // full angle, in (0, 180]
    float softness;       // the fraction of the angle, from the edge inwards, with falloff; in [0, 1]
    SpotFalloff falloff = SpotFalloff::kSmooth;
  };
  // `image_mean` is the mean of the image's texels.
  SpotLight(Vec3 position, Rgb intensity, const Cone& cone, const ProjectedImage& image = {},
            Rgb image_mean = Rgb::gray(1));

  std::optional<LightSample> sample(const std::vector<Texture>& textures, Vec3 p_lit) const;
  double power() const;
  LightBounds bounds() const;

  // The fraction of the full intensity at an angle from the axis; `off_axis` is 1 - its cosine.
  float falloff(float off_axis) const;

 private:
  Rgb projected(const std::vector<Texture>& textures, Vec3 direction) const;

  Vec3 position_;
  Rgb intensity_;
  Vec3 axis_;
  float mean_intensity_;             // on the axis, over the image and all channels
  float inner_edge_, outer_edge_;    // 1 - cos of the angles where falloff begins and ends
  float inner_angle_, outer_angle_;  // these, in radians
  SpotFalloff falloff_;
  ProjectedImage image_;  // its right and up over their squared lengths
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

}  // namespace tessera::core::lights
