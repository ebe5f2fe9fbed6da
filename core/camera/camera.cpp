// SPDX-License-Identifier: Apache-2.0
#include "core/camera/camera.hpp"

#include "core/math/elementary.hpp"

namespace tessera::core {
namespace {

float tan_half(float degrees) {
  const float half_angle = degrees * (kPi / 360);
  return sin(half_angle) / cos(half_angle);
}

}  // namespace

Camera::Camera(const CameraDescription& description)
    : type_(description.type),
      position_(description.position),
      forward_(normalize(description.look_at - description.position)),
      height_(type_ == CameraType::kOrthographic ? description.view_height
                                                 : 2 * tan_half(description.vertical_fov_degrees)),
      shift_(description.lens_shift),
      aperture_(description.aperture_radius, description.aperture_blades,
                description.aperture_rotation_degrees),
      focus_distance_(description.focus_distance > 0 ? description.focus_distance
                                                     : length(description.look_at - description.position)) {
  right_ = normalize(cross(forward_, description.up));
  up_ = cross(right_, forward_);
  if (description.mirrored) right_ = -right_;
}

Ray Camera::ray(Vec2 raster, int width_px, int height_px, Vec2 u_lens) const {
  const auto width = static_cast<float>(width_px), height = static_cast<float>(height_px);
  if (type_ == CameraType::kPanoramic) return panoramic_ray({raster.x / width, raster.y / height});
  const float pixel = height_ / height;
  const float x = (raster.x - (width / 2 - shift_.x * width)) * pixel;
  const float y = (height / 2 + shift_.y * height - raster.y) * pixel;
  if (type_ == CameraType::kOrthographic)
    return through_lens(position_ + right_ * x + up_ * y, forward_, u_lens);
  return through_lens(position_, forward_ + right_ * x + up_ * y, u_lens);
}

float Camera::depth(Vec3 origin, Vec3 point) const {
  if (type_ == CameraType::kPanoramic) return length(point - origin);
  const float along = dot(point - origin, forward_);
  return along > 0 ? along : 0;
}

Ray Camera::through_lens(Vec3 position, Vec3 direction, Vec2 u_lens) const {
  if (aperture_.is_pinhole()) return Ray{position, normalize(direction)};
  const Vec2 lens = aperture_.sample(u_lens);
  const Vec3 offset = right_ * lens.x + up_ * lens.y;
  return Ray{position + offset, normalize(direction - offset / focus_distance_)};
}

// `image` is in units of its width and height, from the top left.
Ray Camera::panoramic_ray(Vec2 image) const {
  const auto [sin_longitude, cos_longitude] = sin_cos_turns(image.x - 0.5f);
  const auto [sin_latitude, cos_latitude] = sin_cos_turns(0.25f - image.y / 2);
  const Vec3 level = forward_ * cos_longitude + right_ * sin_longitude;
  return Ray{position_, normalize(level * cos_latitude + up_ * sin_latitude)};
}

}  // namespace tessera::core
