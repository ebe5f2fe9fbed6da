// SPDX-License-Identifier: Apache-2.0
// The infinite lights of a scene as one environment. Their images are square, in the equal-area octahedral
// mapping (Clarberg 2008), and are resampled to an equirectangular one. Not thread-safe.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/base/error.hpp"
#include "core/scene/description.hpp"
#include "core/scene/import/scene_builder.hpp"
#include "core/scene/pbrt/matrix.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core::pbrt {

// The point of the unit square for a unit direction, and back.
Vec2 equal_area_square(Vec3 direction);
Vec3 equal_area_direction(Vec2 point);

class EnvironmentMap {
 public:
  void add_constant(Rgb radiance) {
    constant_ += radiance;
    has_light_ = true;
  }
  // `from_world` maps directions of the world to those of the image, which is square, or else equirectangular
  // with its pole along +z. `scale` multiplies the image.
  void add_image(std::shared_ptr<const TextureImage> image, const Matrix& from_world, Rgb scale);

  // The sum of all, in the world's directions. There must be an image.
  TextureImage equirectangular() const;
  TextureSize size() const { return {2 * height(), height()}; }  // of this image
  // Sets the environment of the scene, if there is one. RESOURCE_EXHAUSTED beyond the limits on textures.
  Status finish(SceneBuilder& builder) const;

 private:
  struct Layer {
    std::shared_ptr<const TextureImage> image;
    Matrix from_world;
    Rgb scale;

    Rgb radiance(Vec3 direction) const;
  };

  int height() const;

  Rgb constant_{};
  std::vector<Layer> layers_;
  bool has_light_ = false;
};

// The illuminance on a surface that faces +z of a square image of radiance, as pbrt computes it to scale an
// image to a given illuminance.
double upper_illuminance(const TextureImage& image);

}  // namespace tessera::core::pbrt
