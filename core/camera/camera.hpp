// SPDX-License-Identifier: Apache-2.0
// A thin-lens camera; a pinhole if the aperture radius is 0.
#pragma once

#include "core/camera/aperture.hpp"
#include "core/camera/camera_description.hpp"
#include "core/geometry/ray.hpp"
#include "core/math/frame.hpp"

namespace tessera::core {

class Camera {
 public:
  Camera() = default;
  explicit Camera(const CameraDescription& description);

  // The ray through `raster` (pixels from the top left of the image, y downwards) and the lens point
  // selected by `u_lens` in [0, 1)^2. The direction has unit length.
  Ray ray(Vec2 raster, int width_px, int height_px, Vec2 u_lens) const;

 private:
  Vec3 position_;
  Vec3 right_, up_, forward_;
  float tan_half_fov_ = 1;
  Aperture aperture_;
  float focus_distance_ = 1;
};

}  // namespace tessera::core
