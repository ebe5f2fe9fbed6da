// SPDX-License-Identifier: Apache-2.0
// The environment light: infinitely distant light from all directions, either constant or given by an
// equirectangular image. Immutable, shared by all threads.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/lights/environment_distribution.hpp"
#include "core/lights/equirectangular.hpp"
#include "core/lights/light_sample.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core::lights {

class Environment {
 public:
  // If `image` is null, the environment has constant `radiance`; else `radiance` multiplies the image,
  // which is placed as described in EquirectangularMap. If it is not visible to the camera, camera rays that
  // escape are black; that is left to integrators.
  Environment(Rgb radiance, std::shared_ptr<const TextureImage> image, float rotation_degrees,
              const Transform& orientation = {}, bool visible_to_camera = true);

  bool visible_to_camera() const { return visible_to_camera_; }

  // Radiance from a direction of any non-zero length. Texels are interpolated bilinearly.
  Rgb radiance(Vec3 direction) const;

  // Samples a direction in proportion to the mean of the channels times the cosine to `normal`, or without
  // a cosine for the zero normal (LightSampleContext::normal); see EnvironmentDistribution. Without MIS
  // compensation the density is positive wherever radiance() is not black.
  std::optional<LightSample> sample(Vec3 normal, Vec2 u,
                                    MisCompensation compensation = MisCompensation::kOff) const;
  float pdf(Vec3 normal, Vec3 direction, MisCompensation compensation = MisCompensation::kOff) const;

  // radiance() and pdf() for directions in lanes.
  struct Seen {
    RgbOf<FloatN> radiance;
    FloatN pdf;
  };
  Seen see(Vec3Of<FloatN> normals, Vec3Of<FloatN> directions,
           MisCompensation compensation = MisCompensation::kOff) const;
  // sample() in lanes, without points. In lanes without a sample, wi is not zero.
  LightSamples sample(Vec3Of<FloatN> normals, Vec2Of<FloatN> u,
                      MisCompensation compensation = MisCompensation::kOff) const;

  // The power that reaches a disk of the scene's radius from all directions, in watts, averaged over the
  // channels.
  double power(double scene_radius) const;

  // EnvironmentDistribution::importance_by_normal for the mean of the channels, by the surface's
  // normal_bin().
  const std::vector<EnvironmentDistribution::Importance>& importance_by_normal() const {
    return distribution_->importance_by_normal();
  }

 private:
  RgbOf<FloatN> radiance_at(Vec2Of<FloatN> uv) const;  // of the image

  Rgb radiance_;
  std::shared_ptr<const TextureImage> image_;
  EquirectangularMap map_;
  bool visible_to_camera_;
  std::shared_ptr<const EnvironmentDistribution> distribution_;
};

}  // namespace tessera::core::lights
