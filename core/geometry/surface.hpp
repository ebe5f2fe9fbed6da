// The point of a surface that a ray has hit, and rays that leave from it.
#pragma once

#include "core/math/vec3.hpp"

namespace tessera::core {

// The surface at a hit, in world space.
struct SurfacePoint {
  Vec3 position;
  Vec3 position_error;    // absolute bounds on the rounding error of each coordinate of `position`
  Vec3 geometric_normal;  // unit, outward: of counter-clockwise triangles, and away from sphere centres;
                          // turned to the side of the interpolated normal where the mesh has normals
  Vec3 shading_normal;    // unit, interpolated; in the hemisphere of geometric_normal
  Vec2 uv;
};

// The directions on the surface in which the position moves as one texture coordinate grows and the other
// stays: dp/du and dp/dv without their lengths. Both zero where there are none, as without texture
// coordinates.
struct Tangents {
  Vec3 along_u, along_v;
};

// Moves a ray's origin off its surface, to the side `direction` leaves from, far enough that rounding cannot
// put it on the wrong side and no farther (Pharr et al. 2023, section 6.8.6).
Vec3 offset_origin(const SurfacePoint& surface, Vec3 direction);

}  // namespace tessera::core
