// SPDX-License-Identifier: Apache-2.0
// Maps directions to positions of an equirectangular environment image, seen from inside: the middle looks
// along -z, +x is to the right, and the upper edge is +y. Longitude and latitude are linear in u and v.
#pragma once

#include <cmath>

#include "core/math/elementary.hpp"
#include "core/math/transform.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core::lights {

class EquirectangularMap {
 public:
  // Rotates the image about +y, counter-clockwise seen from above, and then by `orientation`, which must be a
  // rotation or a reflection; its origin has no effect.
  explicit EquirectangularMap(float rotation_degrees, const Transform& orientation = {})
      : turned_(fraction(rotation_degrees / 360)),
        is_oriented_(!is_identity(orientation)),
        x_axis_(orientation.x_axis),
        y_axis_(orientation.y_axis),
        z_axis_(orientation.z_axis) {}

  // The image position of a direction of any non-zero length.
  template <typename T>
  Vec2Of<T> uv_of(Vec3Of<T> toward) const {
    using std::sqrt;
    const Vec3Of<T> d = is_oriented_ ? to_image(toward) : toward;
    constexpr float kInvPi = 1 / kPi;
    const T longitude = atan2(d.x, -d.z), latitude = atan2(d.y, sqrt(d.x * d.x + d.z * d.z));
    return {fraction(0.5f + (longitude * (kInvPi / 2) + turned_)), 0.5f + latitude * kInvPi};
  }

  // The unit direction at u = `along_row` and a distance of `depth` below the upper pole (`side` 1) or
  // above the lower one (-1), on the unit sphere. Equal heights have equal areas there (Archimedes).
  template <typename T>
  Vec3Of<T> direction(T along_row, T depth, T side) const {
    using std::sqrt;
    const auto [sine, cosine] = sin_cos_turns(along_row - 0.5f - turned_);
    const T horizontal = sqrt(depth * (2 - depth));
    const auto in_image = normalize(Vec3Of<T>{horizontal * sine, side * (1 - depth), -horizontal * cosine});
    return is_oriented_ ? to_world(in_image) : in_image;
  }

 private:
  template <typename T>
  static T fraction(T x) {
    using std::floor;
    return x - floor(x);
  }

  static bool is_identity(const Transform& t) {
    const Transform none;
    return t.x_axis == none.x_axis && t.y_axis == none.y_axis && t.z_axis == none.z_axis;
  }
  template <typename T>
  Vec3Of<T> to_image(Vec3Of<T> d) const {
    return {dot(in_lanes<T>(x_axis_), d), dot(in_lanes<T>(y_axis_), d), dot(in_lanes<T>(z_axis_), d)};
  }
  template <typename T>
  Vec3Of<T> to_world(Vec3Of<T> d) const {
    return normalize(in_lanes<T>(x_axis_) * d.x + in_lanes<T>(y_axis_) * d.y + in_lanes<T>(z_axis_) * d.z);
  }
  template <typename T>
  static Vec3Of<T> in_lanes(Vec3 v) {
    return {T(v.x), T(v.y), T(v.z)};
  }

  float turned_;
  bool is_oriented_;
  Vec3 x_axis_, y_axis_, z_axis_;  // of the orientation
};

}  // namespace tessera::core::lights
