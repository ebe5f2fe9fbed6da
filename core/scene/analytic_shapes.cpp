// SPDX-License-Identifier: Apache-2.0
#include "core/scene/analytic_shapes.hpp"

#include "core/math/frame.hpp"

namespace tessera::core {

DiskDescription make_disk(Vec3 center, Vec3 normal, float radius, float inner_radius) {
  const Frame frame = Frame::around(unit_or_zero(Vec3d(normal)));
  return {.center = center,
          .radius_u = frame.tangent * radius,
          .radius_v = frame.bitangent * radius,
          .inner = inner_radius / radius};
}

CylinderDescription make_cylinder(Vec3 start, Vec3 end, float radius) {
  const Frame frame = Frame::around(unit_or_zero(Vec3d(end) - Vec3d(start)));
  return {.start = start,
          .axis = end - start,
          .radius_u = frame.tangent * radius,
          .radius_v = frame.bitangent * radius};
}

DiskDescription placed(const DiskDescription& disk, const Transform& transform) {
  DiskDescription moved = disk;
  moved.center = transform.point(disk.center);
  moved.radius_u = transform.direction(disk.radius_u);
  moved.radius_v = transform.direction(disk.radius_v);
  if (transform.determinant() < 0) moved.flipped = !disk.flipped;
  return moved;
}

CylinderDescription placed(const CylinderDescription& cylinder, const Transform& transform) {
  CylinderDescription moved = cylinder;
  moved.start = transform.point(cylinder.start);
  moved.axis = transform.direction(cylinder.axis);
  moved.radius_u = transform.direction(cylinder.radius_u);
  moved.radius_v = transform.direction(cylinder.radius_v);
  return moved;
}

Disk geometry_of(const DiskDescription& d) {
  return {d.center, d.radius_u, d.radius_v, d.inner, d.flipped};
}

Cylinder geometry_of(const CylinderDescription& c) {
  return {c.start, c.axis, c.radius_u, c.radius_v, c.flipped};
}

}  // namespace tessera::core
