// SPDX-License-Identifier: Apache-2.0
#include "core/camera/camera.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/math/elementary.hpp"
#include "core/math/simd.hpp"

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

template <typename T>
RayOf<T> Camera::ray(Vec2Of<T> raster, int width_px, int height_px, Vec2Of<T> u_lens) const {
  if (type_ == CameraType::kPanoramic)
    return panoramic_ray(
        Vec2Of<T>{raster.x / static_cast<float>(width_px), raster.y / static_cast<float>(height_px)});
  return through_lens(chief_ray(raster, width_px, height_px), u_lens);
}

template <typename T>
Camera::LineOf<T> Camera::chief_ray(Vec2Of<T> raster, int width_px, int height_px) const {
  const auto width = static_cast<float>(width_px), height = static_cast<float>(height_px);
  const float pixel = height_ / height;
  const T x = (raster.x - (width / 2 - shift_.x * width)) * pixel;
  const T y = (height / 2 + shift_.y * height - raster.y) * pixel;
  const auto position = broadcast<T>(position_), right = broadcast<T>(right_), up = broadcast<T>(up_),
             forward = broadcast<T>(forward_);
  if (type_ == CameraType::kOrthographic) return {position + right * x + up * y, forward};
  return {position, forward + right * x + up * y};
}

float Camera::depth(Vec3 origin, Vec3 point) const {
  if (type_ == CameraType::kPanoramic) return length(point - origin);
  const float along = dot(point - origin, forward_);
  return along > 0 ? along : 0;
}

template <typename T>
RayOf<T> Camera::through_lens(const LineOf<T>& line, Vec2Of<T> u_lens) const {
  const auto& [position, direction] = line;
  if (aperture_.is_pinhole()) return {position, normalize(direction)};
  const Vec2Of<T> lens = aperture_.sample(u_lens);
  const auto right = broadcast<T>(right_), up = broadcast<T>(up_);
  const Vec3Of<T> offset = right * lens.x + up * lens.y;
  return {position + offset, normalize(direction - offset / T(focus_distance_))};
}

Vec3 Camera::focus(Vec2 raster, int width_px, int height_px) const {
  const auto [position, direction] = chief_ray(raster, width_px, height_px);
  return position + direction * focus_distance_;
}

Vec3 Camera::lens_center(Vec3 focus) const {
  return type_ == CameraType::kOrthographic ? focus - forward_ * focus_distance_ : position_;
}

// The lens is uniformly sampled. Seen from the focus, an area of it at the distance d takes up the solid
// angle area * cosine / d^2.
float Camera::lens_pdf(Vec3 direction) const {
  const float cosine = dot(direction, forward_);
  return focus_distance_ * focus_distance_ / (cosine * cosine * cosine * aperture_.area());
}

std::optional<Vec3> Camera::lens_point(Vec3 focus, Vec3 direction) const {
  const float cosine = dot(direction, forward_);
  if (!(cosine > 0)) return std::nullopt;
  const Vec3 center = lens_center(focus);
  const Vec3 offset = (focus - center) - direction * (focus_distance_ / cosine);
  const Vec2 lens{dot(offset, right_), dot(offset, up_)};
  if (!aperture_.contains(lens)) return std::nullopt;
  return center + right_ * lens.x + up_ * lens.y;
}

DoubleCone Camera::lens_cone(Vec3 focus) const {
  const Vec3 line = focus - lens_center(focus);
  const float distance = length(line);
  const float sine = std::min(1.0f, aperture_.radius() / distance);
  return {focus, line / distance, std::sqrt(1 - sine * sine), sine};
}

float Camera::share_of_lens(float area, Vec3 point, float radius) const {
  const float depth = dot(point - position_, forward_);
  if (depth - radius <= 0) return 0;
  const float gap = std::fabs(depth - focus_distance_) - radius;
  if (!(gap > 0)) return std::numeric_limits<float>::infinity();
  const float scale = focus_distance_ / gap;
  return area * scale * scale / aperture_.area();
}

// `image` is in units of its width and height, from the top left.
template <typename T>
RayOf<T> Camera::panoramic_ray(Vec2Of<T> image) const {
  const auto [sin_longitude, cos_longitude] = sin_cos_turns(image.x - 0.5f);
  const auto [sin_latitude, cos_latitude] = sin_cos_turns(0.25f - image.y / 2);
  const auto position = broadcast<T>(position_), right = broadcast<T>(right_), up = broadcast<T>(up_),
             forward = broadcast<T>(forward_);
  const Vec3Of<T> level = forward * cos_longitude + right * sin_longitude;
  return {position, normalize(level * cos_latitude + up * sin_latitude)};
}

template Ray Camera::ray(Vec2, int, int, Vec2) const;
template RayOf<FloatN> Camera::ray(Vec2Of<FloatN>, int, int, Vec2Of<FloatN>) const;

}  // namespace tessera::core
