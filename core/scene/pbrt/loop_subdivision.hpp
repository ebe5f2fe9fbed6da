// SPDX-License-Identifier: Apache-2.0
// Loop subdivision surfaces (Loop 1987), with the extensions for boundaries of Hoppe et al. 1994. Stateless;
// thread-safe.
#pragma once

#include "core/scene/description.hpp"

namespace tessera::core::pbrt {

inline constexpr int kMaxSubdivisionLevels = 8;

// Divides each triangle of the control mesh into 4^levels, and moves the vertices to the limit surface, whose
// normals they get. Indices must be valid, and `levels` at most kMaxSubdivisionLevels. Edges of more than two
// triangles count as boundaries.
MeshDescription subdivide(const MeshDescription& control, int levels);

}  // namespace tessera::core::pbrt
