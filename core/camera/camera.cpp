// SPDX-License-Identifier: Apache-2.0
#include "core/camera/camera.hpp"

#include "core/math/elementary.hpp"

namespace tessera::core {

Camera::Camera(const CameraDescription& description)
    : position_(description.position),
      forward_(normalize(description.look_at - description.position)),
      aperture_(description.aperture_radius, description.aperture_blades,
                description.aperture_rotation_degrees),
      focus_distance_(description.focus_distance > 0 ? description.focus_distance
                                                     : length(description.look_at - description.position)) {
  right_ = normalize(cross(forward_, description.up));
  up_ = cross(right_, forward_);
  const float half_angle = description.vertical_fov_degrees * (kPi / 360);
  tan_half_fov_ = sin(half_angle) / cos(half_angle);
}

Ray Camera::ray(Vec2 raster, int width_px, int height_px, Vec2 u_lens) const {
  const float pixel = 2 * tan_half_fov_ / static_cast<float>(height_px);
  const float x = (raster.x - static_cast<float>(width_px) / 2) * pixel;
  const float y = (static_cast<float>(height_px) / 2 - raster.y) * pixel;
  const Vec3 through_center = forward_ + right_ * x + up_ * y;
  if (aperture_.is_pinhole()) return Ray{position_, normalize(through_center)};
  const Vec2 lens = aperture_.sample(u_lens);
  const Vec3 offset = right_ * lens.x + up_ * lens.y;
  return Ray{position_ + offset, normalize(through_center - offset / focus_distance_)};
}

}  // namespace tessera::core
