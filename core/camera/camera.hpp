// SPDX-License-Identifier: Apache-2.0
// The camera of a scene: which rays sample a pixel. Immutable.
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
  // How far a point is from the origin of a camera ray that meets it, along the line of sight; for panoramic
  // cameras, their distance. Not negative.
  float depth(Vec3 origin, Vec3 point) const;

 private:
  Ray panoramic_ray(Vec2 image) const;
  // A ray from a point of the lens that meets `position` + t `direction` at the focus distance; `direction`
  // is 1 long along the line of sight.
  Ray through_lens(Vec3 position, Vec3 direction, Vec2 u_lens) const;

  CameraType type_ = CameraType::kPerspective;
  Vec3 position_;
  Vec3 right_, up_, forward_;
  float height_ = 2;  // of the image: at the distance 1 if perspective, in the world if orthographic
  Vec2 shift_;
  Aperture aperture_;
  float focus_distance_ = 1;
};

}  // namespace tessera::core
