// SPDX-License-Identifier: Apache-2.0
// Light from infinitely far away in all directions: one radiance, or an equirectangular picture of the
// environment. Immutable, shared by all threads.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/lights/environment_distribution.hpp"
#include "core/lights/equirectangular.hpp"
#include "core/lights/light_sample.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

class Environment {
 public:
  // `image` may be null: then `radiance` comes from everywhere; else it multiplies the picture, which is
  // turned as EquirectangularMap says.
  Environment(Rgb radiance, std::shared_ptr<const TextureImage> image, float rotation_degrees);

  // From a direction, of any length but 0. Bilinear between the picture's texels.
  Rgb radiance(Vec3 direction) const;

  // A direction to a surface with this normal, or to one that is lit from all sides
  // (LightSampleContext::normal), in proportion to the mean of the channels and the cosine
  // (EnvironmentDistribution). Wherever radiance() is not black there is a density.
  std::optional<LightSample> sample(Vec3 normal, Vec2 u) const;
  float pdf(Vec3 normal, Vec3 direction) const;

  // radiance() and pdf() of eight directions.
  struct Seen {
    RgbOf<Float8> radiance;
    Float8 pdf;
  };
  Seen see(Vec3Of<Float8> normals, Vec3Of<Float8> directions) const;
  // sample() of eight, without points. Where nothing is found, wi is not zero.
  LightSamples sample(Vec3Of<Float8> normals, Vec2Of<Float8> u) const;

  // Watts, the mean of the channels, that fall on a disk of the scene's radius, from all sides.
  double power(double scene_radius) const;

  // EnvironmentDistribution::importance_by_normal: of the mean of the channels, by normal_bin() of the
  // surface.
  const std::vector<double>& importance_by_normal() const { return distribution_->importance_by_normal(); }

 private:
  RgbOf<Float8> radiance_at(Vec2Of<Float8> uv) const;  // of the picture

  Rgb radiance_;
  std::shared_ptr<const TextureImage> image_;
  EquirectangularMap map_;
  std::shared_ptr<const EnvironmentDistribution> distribution_;
};

}  // namespace tessera::core
