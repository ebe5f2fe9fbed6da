// SPDX-License-Identifier: Apache-2.0
// Ray-cylinder intersection, in double from float data. A cylinder is the lateral surface of the unit
// cylinder (radius 1 about z, 0 <= z <= 1) under any affine map, without caps.
#pragma once

#include <optional>

#include "core/geometry/aabb.hpp"
#include "core/geometry/disk.hpp"
#include "core/geometry/object_point.hpp"
#include "core/geometry/object_ray.hpp"
#include "core/geometry/placement.hpp"
#include "core/geometry/vec3d.hpp"
#include "core/math/transform.hpp"

namespace tessera::core {

class Cylinder {
 public:
  // Of the points start + z axis + cos(a) radius_u + sin(a) radius_v, as CylinderDescription. The map must
  // satisfy Placement::can_place().
  Cylinder(Vec3 start, Vec3 axis, Vec3 radius_u, Vec3 radius_v, bool flipped)
      : place_(Transform{radius_u, radius_v, axis, start}), flipped_(flipped) {}
  static bool can_be_hit(Vec3 start, Vec3 axis, Vec3 radius_u, Vec3 radius_v) {
    return Placement::can_place({radius_u, radius_v, axis, start});
  }
  // The map of the unit cylinder.
  Transform transform() const { return place_.transform(); }
  bool flipped() const { return flipped_; }

  // Bounds of every point of the surface, rounded outwards.
  Aabb bounds() const;

  struct Hit {
    double t;
    Vec3d unit;  // the point on the unit cylinder
  };
  // The smallest provably positive t. An origin that is indistinguishable from a point of the surface counts
  // as on it: from there only the opposite side can be hit.
  std::optional<Hit> intersect(const ObjectRay& ray) const;

  // The surface where the ray met the cylinder. If it does not meet it, a point of the surface.
  ObjectPointOf<float> point(const ObjectRay& ray) const;

  // The derivatives of the position by the texture coordinates.
  WideDerivatives derivatives(Vec2 uv) const;

  // The position at texture coordinates.
  Vec3d position(Vec2 uv) const;
  double area() const;

 private:
  Vec3d outward(Vec3d unit) const;

  Placement place_;
  bool flipped_;
};

// The area of the lateral surface (radius_u, radius_v and axis as above).
double cylinder_area(Vec3d axis, Vec3d radius_u, Vec3d radius_v);

}  // namespace tessera::core
