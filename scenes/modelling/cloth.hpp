// SPDX-License-Identifier: Apache-2.0
// Drapes a rectangular cloth over things, by position-based dynamics (Müller et al. 2007). Deterministic: no
// threads, no random state.
#pragma once

#include <functional>

#include "scenes/modelling/surface.hpp"

namespace tessera::modelling {

struct Cloth {
  int columns = 100, rows = 100;  // of squares that are simulated
  int refinement = 2;             // squares of the mesh along a simulated square's side, on a smooth surface
  float spacing = 1;              // length of a square's side at rest
  // Where the vertex of a square's corner starts: u and v in [0, 1].
  std::function<Vec3(float u, float v)> start;
  // Moves a point that is inside an obstacle to its surface, and leaves others alone.
  std::function<Vec3(Vec3)> push_out;
  float gravity = 0.01f;           // length per step per step
  float damping = 0.02f;           // share of the velocity that is lost in each step
  float friction = 0.5f;           // share of the movement along an obstacle that is lost in each step
  float stiffness_bending = 0.1f;  // 0 for tissue, 1 for cardboard
  int steps = 500;
  int iterations = 20;  // of the constraints, in each step
};

// The cloth when it has come to rest: a mesh of 2 * columns * rows * refinement^2 triangles.
MeshDescription drape(const Cloth& cloth);

}  // namespace tessera::modelling
