// SPDX-License-Identifier: Apache-2.0
// Ray-triangle intersection: the watertight test of Woop, Benthin and Wald 2013. The ray is sheared onto
// the z axis, and the signs of three edge functions say whether the origin of the xy plane lies in the
// triangle.
//
// It is computed in double from float data. An edge function then never has the wrong sign, and is exactly
// 0 (which counts as inside) if undecided; neighbours evaluate a shared edge to opposite values. So no ray
// passes between neighbours. Nothing overflows for any finite floats.
#pragma once

#include <array>
#include <optional>

#include "core/geometry/object_ray.hpp"
#include "core/geometry/ray.hpp"
#include "core/geometry/vec3d.hpp"

namespace tessera::core {

// Branch-free, because the axes of incoherent rays are unpredictable.
template <typename Vector>
int longest_axis(const Vector& v) {
  const Vector a = abs(v);
  const int of_xy = a.x > a.y ? 0 : 1;
  return (a.x > a.y ? a.x : a.y) > a.z ? of_xy : 2;
}

// A ray prepared for any number of triangle tests. Its z is the axis along which the direction is longest.
struct ShearedRay {
  ShearedRay() = default;
  template <typename AnyRay>
  explicit ShearedRay(const AnyRay& ray) {
    z_axis = longest_axis(ray.direction);
    x_axis = (z_axis + 1) % 3;
    y_axis = (z_axis + 2) % 3;
    origin_x = ray.origin[x_axis];
    origin_y = ray.origin[y_axis];
    origin_z = ray.origin[z_axis];
    direction_z = ray.direction[z_axis];
    shear_x = static_cast<double>(ray.direction[x_axis]) / direction_z;
    shear_y = static_cast<double>(ray.direction[y_axis]) / direction_z;
  }

  int axis(int xyz) const { return xyz == 0 ? x_axis : xyz == 1 ? y_axis : z_axis; }

  int x_axis, y_axis, z_axis;
  double origin_x, origin_y, origin_z;
  double shear_x, shear_y;  // the direction's x and y per unit of z
  double direction_z;

  // A point relative to the origin, with the direction sheared onto the z axis.
  Vec3d shear(Vec3 p) const {
    const double x = static_cast<double>(p[x_axis]) - origin_x;
    const double y = static_cast<double>(p[y_axis]) - origin_y;
    const double z = static_cast<double>(p[z_axis]) - origin_z;
    return {x - shear_x * z, y - shear_y * z, z};
  }
};

using TriangleCorners = std::array<Vec3, 3>;

struct TriangleHit {
  float t, b1, b2;  // as in Hit; 0 <= b1, b2 <= 1
};

// The hit of the line in front of the origin, from either side. None if t is not provably positive, so that
// a ray does not hit the surface it starts on.
std::optional<TriangleHit> intersect_triangle(const ShearedRay& ray, const TriangleCorners& corners);

// A normal whose length is twice the area, on the side from which the corners are counter-clockwise.
// Accurate for needle-shaped triangles and at any scale.
Vec3d area_normal(const TriangleCorners& corners);

// Whether the triangle has an area; triangles without one are never hit.
inline bool can_be_hit(const TriangleCorners& corners) {
  return has_direction(area_normal(corners));
}

}  // namespace tessera::core
