// SPDX-License-Identifier: Apache-2.0
// Maps directions to positions of an equirectangular environment image, seen from inside: the middle looks
// along -z, +x is to the right, and the upper edge is +y. Longitude and latitude are linear in u and v.
#pragma once

#include <cmath>

#include "core/math/elementary.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

class EquirectangularMap {
 public:
  // Rotates the image about +y, counter-clockwise seen from above.
  explicit EquirectangularMap(float rotation_degrees) : turned_(fraction(rotation_degrees / 360)) {}

  // The image position of a direction of any non-zero length.
  template <typename T>
  Vec2Of<T> uv_of(Vec3Of<T> d) const {
    using std::sqrt;
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
    return normalize(Vec3Of<T>{horizontal * sine, side * (1 - depth), -horizontal * cosine});
  }

 private:
  template <typename T>
  static T fraction(T x) {
    using std::floor;
    return x - floor(x);
  }

  float turned_;
};

}  // namespace tessera::core
