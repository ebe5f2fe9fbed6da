// SPDX-License-Identifier: Apache-2.0
// The surface of a field as triangles, by marching cubes (Lorensen and Cline 1987). Thread-safe, and the same
// bytes on every machine.
#pragma once

#include "core/scene/description.hpp"
#include "scenes/modelling/implicit.hpp"

namespace tessera::modelling {

// Cubes of `size`, from `low` on until they cover `high`.
struct CubeLattice {
  Vec3 low, high;
  float size;
};

// The mesh is a closed manifold, counter-clockwise seen from outside, whatever the field: where cubes leave a
// choice, all choose alike, and what reaches the outermost corners of the lattice is cut off before them.
// Normals are the field's gradients. No uvs.
core::MeshDescription marching_cubes(const Field& field, const CubeLattice& lattice);

}  // namespace tessera::modelling
