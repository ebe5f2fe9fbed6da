// SPDX-License-Identifier: Apache-2.0
// The point of a surface that a ray has hit, and rays that leave from it.
#pragma once

#include "core/geometry/rounding.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

// The surface at a hit, in world space.
template <typename T>
struct SurfacePointOf {
  Vec3Of<T> position;
  Vec3Of<T> position_error;    // absolute bounds on the rounding error of each coordinate of `position`
  Vec3Of<T> geometric_normal;  // unit, outward: of counter-clockwise triangles, and away from sphere centres
  Vec3Of<T> shading_normal;    // unit, interpolated, and turned to the side of geometric_normal
  Vec2Of<T> uv;
};
using SurfacePoint = SurfacePointOf<float>;

// The directions on the surface in which the position moves as one texture coordinate grows and the other
// stays: dp/du and dp/dv without their lengths. Both zero where there are none, as without texture
// coordinates.
struct Tangents {
  Vec3 along_u, along_v;
};

// How the position on the surface changes with each texture coordinate; both zero where there are none.
struct UvDerivatives {
  Vec3 dp_du, dp_dv;
};

// Moves a ray's origin off its surface, to the side `direction` leaves from, far enough that rounding cannot
// put it on the wrong side and no farther (Pharr et al. 2023, section 6.8.6).
template <typename T>
Vec3Of<T> offset_origin(const SurfacePointOf<T>& surface, Vec3Of<T> direction) {
  const Vec3Of<T> normal = face_toward(surface.geometric_normal, direction);
  // The extent along the normal of the box that the true point lies in.
  const Vec3Of<T> offset = normal * dot(abs(normal), surface.position_error);
  const Vec3Of<T> moved = surface.position + offset;
  return {rounded_away(moved.x, offset.x), rounded_away(moved.y, offset.y), rounded_away(moved.z, offset.z)};
}

}  // namespace tessera::core
