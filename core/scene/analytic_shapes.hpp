// SPDX-License-Identifier: Apache-2.0
// Disks and cylinders of scene descriptions: made from the usual parameters, transformed, and as geometry.
// Pure functions.
#pragma once

#include "core/geometry/cylinder.hpp"
#include "core/geometry/disk.hpp"
#include "core/math/transform.hpp"
#include "core/scene/description.hpp"

namespace tessera::core {

// `normal` must have a direction. The angle 0 is an arbitrary direction, +x for the normal +z.
DiskDescription make_disk(Vec3 center, Vec3 normal, float radius, float inner_radius = 0);
// `start` and `end` must differ. The angle 0 is an arbitrary direction, +x for an axis along +z.
CylinderDescription make_cylinder(Vec3 start, Vec3 end, float radius);

// Under an affine map. A reflection keeps the front outside.
DiskDescription placed(const DiskDescription& disk, const Transform& transform);
CylinderDescription placed(const CylinderDescription& cylinder, const Transform& transform);

Disk geometry_of(const DiskDescription& disk);
// The cylinder must satisfy Cylinder::can_be_hit().
Cylinder geometry_of(const CylinderDescription& cylinder);

}  // namespace tessera::core
