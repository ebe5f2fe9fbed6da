// SPDX-License-Identifier: Apache-2.0
// The surface point that a ray has hit, and spawning rays from it.
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
  Vec3Of<T> shading_normal;    // unit, interpolated, in the hemisphere of geometric_normal
  Vec2Of<T> uv;
};
using SurfacePoint = SurfacePointOf<float>;

// Unit tangents: the directions of dp/du and dp/dv. Both are zero if undefined, as without texture
// coordinates.
struct Tangents {
  Vec3 along_u, along_v;
};

// The tangent frame that a mesh gives a vertex: the direction in which normal maps and anisotropic highlights
// take u to grow, and handedness 1 or -1. The bitangent is handedness * cross(normal, direction) (glTF 2.0
// specification, section 3.7.2.1). The direction is zero if the vertex has none.
struct VertexTangent {
  Vec3 direction;
  float handedness = 1;

  bool operator==(const VertexTangent&) const = default;
};

// dp/du and dp/dv; both zero if undefined.
struct UvDerivatives {
  Vec3 dp_du, dp_dv;
};

// Moves a ray's origin off its surface to the side of `direction`, just far enough that rounding cannot put
// it on the wrong side (Pharr et al. 2023, section 6.8.6).
template <typename T>
Vec3Of<T> offset_origin(const SurfacePointOf<T>& surface, Vec3Of<T> direction) {
  const Vec3Of<T> normal = face_toward(surface.geometric_normal, direction);
  // The extent along the normal of the error box that contains the exact point.
  const Vec3Of<T> offset = normal * dot(abs(normal), surface.position_error);
  const Vec3Of<T> moved = surface.position + offset;
  return {rounded_away(moved.x, offset.x), rounded_away(moved.y, offset.y), rounded_away(moved.z, offset.z)};
}

}  // namespace tessera::core
