// SPDX-License-Identifier: Apache-2.0
// Meshes of curved shapes in their own space, with the normals and texture coordinates that pbrt-v4 defines
// for them. The order of corners may be either: normals say which side is the front. triangle_materials is
// empty. Stateless; thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/math/vec3.hpp"
#include "core/scene/description.hpp"

namespace tessera::core::pbrt {

// The part of a sphere about the origin with z_min <= z <= z_max and longitudes from 0 to phi_max (degrees).
struct PartialSphere {
  float radius = 1, z_min = -1, z_max = 1, phi_max = 360;
};
MeshDescription sphere_mesh(const PartialSphere& sphere);

// A sector of a ring around the z axis.
struct PartialDisk {
  float height = 0, radius = 1, inner_radius = 0, phi_max = 360;
};
MeshDescription disk_mesh(const PartialDisk& disk);

struct PartialCylinder {
  float radius = 1, z_min = -1, z_max = 1, phi_max = 360;
};
MeshDescription cylinder_mesh(const PartialCylinder& cylinder);

// Bilinear patches: four indices each, of the corners (0, 0), (1, 0), (0, 1) and (1, 1). Indices must be
// valid; `normals` and `uvs` are empty or have one for each position. Parallelograms become two triangles.
MeshDescription bilinear_mesh(const std::vector<Vec3>& positions, const std::vector<Vec3>& normals,
                              const std::vector<Vec2>& uvs,
                              const std::vector<std::array<std::uint32_t, 4>>& patches);
// How many triangles that makes.
std::uint64_t bilinear_triangles(const std::vector<Vec3>& positions,
                                 const std::vector<std::array<std::uint32_t, 4>>& patches);

}  // namespace tessera::core::pbrt
