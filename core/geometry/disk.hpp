// SPDX-License-Identifier: Apache-2.0
// Ray-disk intersection, in double from float data. A disk may have a hole, and be any ellipse.
#pragma once

#include <optional>

#include "core/geometry/aabb.hpp"
#include "core/geometry/object_point.hpp"
#include "core/geometry/object_ray.hpp"
#include "core/geometry/surface.hpp"
#include "core/geometry/vec3d.hpp"
#include "core/math/elementary.hpp"

namespace tessera::core {

// The angle of (x, y) from +x in turns, counter-clockwise, in [0, 1).
inline float turns_of(float x, float y) {
  const float angle = atan2(y, x) * (0.5f / kPi);
  const float turns = angle < 0 ? angle + 1 : angle;
  return turns < 1 ? turns : 0;
}

// The derivatives of a position by the texture coordinates.
struct WideDerivatives {
  Vec3d along_u, along_v;
};

// As DiskDescription.
struct Disk {
  Vec3 center{};
  Vec3 radius_u{1, 0, 0}, radius_v{0, 1, 0};
  float inner = 0;
  bool flipped = false;

  // Twice the area of the triangle that the radii span; it has no unit length. Each coordinate is rounded
  // once: the products of floats are exact.
  Vec3d normal() const { return cross(Vec3d(radius_u), Vec3d(radius_v)); }
  double area() const;
  // Whether it has a surface; disks without one are never hit.
  bool can_be_hit() const;
  // Bounds of every point of it, rounded outwards; empty if it has no surface.
  Aabb bounds() const;

  struct Hit {
    double t;
    double along_u, along_v;  // the point is center + along_u radius_u + along_v radius_v
  };
  // The hit of the line in front of the origin, from either side. None if t is not provably positive, so that
  // a ray does not hit the disk on which it starts.
  std::optional<Hit> intersect(const ObjectRay& ray) const;
  // The surface where the ray met the disk. If it does not meet it, the centre.
  ObjectPointOf<float> point(const ObjectRay& ray) const;

  WideDerivatives derivatives(Vec2 uv) const;
};

// A uniform point of a ring from the radius `inner` to 1, from `u` in [0, 1)^2.
struct RingPoint {
  float x, y;
  Vec2 uv;  // as of a disk
};
RingPoint sample_ring(float inner, Vec2 u);

}  // namespace tessera::core
