// SPDX-License-Identifier: Apache-2.0
// Makes meshes of other programs' files fit for rendering. Stateless; thread-safe.
#pragma once

#include <cstddef>

#include "core/math/transform.hpp"
#include "core/scene/description.hpp"
#include "core/scene/loader/file_warnings.hpp"

namespace tessera::core {

// What repair_mesh() changed.
struct MeshRepairs {
  std::size_t broken_triangles = 0;  // removed: a corner is no vertex, or is not finite or too far away
  std::size_t flat_triangles = 0;    // removed: without area
  std::size_t broken_normals = 0;    // zero or not finite; the normal of a triangle replaces them
  std::size_t broken_tangents = 0;   // not finite; the directions of texture coordinates replace them
  std::size_t broken_uvs = 0;        // not finite; (0, 0) replaces them
  std::size_t clamped_colors = 0;    // outside [0, 1]
  bool dropped_normals = false;      // lists whose length is not that of the positions
  bool dropped_tangents = false;
  bool dropped_uvs = false;
  bool dropped_colors = false;
};

// Also removes copies of earlier triangles (triangle_filter.hpp). Steps must be sound. Of a mesh that
// deforms, triangles without area stay, since they may gain one. Afterwards the mesh is valid for
// Scene::build, but its materials are not checked and it may be empty.
MeshRepairs repair_mesh(MeshDescription& mesh);

// Says what was changed, at a line of the file; 0 if none applies.
void tell_repairs(const MeshRepairs& repairs, int line, FileWarnings& warnings);

// Applies the transform to positions, normals and tangents, and makes the last two unit vectors. The identity
// changes nothing. A reflection reverses the order of each triangle's corners, so that its outside stays
// outside.
void transform_mesh(MeshDescription& mesh, const Transform& transform);

}  // namespace tessera::core
