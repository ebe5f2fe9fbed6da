// SPDX-License-Identifier: Apache-2.0
// Builds triangle meshes from parametric surfaces. Thread-safe. Nothing here calls the C library's elementary
// functions, so a mesh is the same bytes on every machine.
#pragma once

#include <functional>
#include <vector>

#include "core/math/vec3.hpp"
#include "core/scene/description.hpp"

namespace tessera::modelling {

using core::MeshDescription;
using core::Vec2;
using core::Vec3;

// Where a surface is sampled: increasing values from 0 to 1 in each direction.
struct GridLines {
  std::vector<float> u, v;
  bool wraps_u = false;  // u = 1 is u = 0 again: evaluated there, so that the seam closes exactly
};

// n + 1 values from 0 to 1.
std::vector<float> uniform_lines(int n);

// The surface p(u, v), with uv = (u, v) and smooth normals; dp/du x dp/dv points outward. Triangles that have
// shrunk to nothing, as at a pole, are left out.
MeshDescription grid_mesh(const GridLines& lines, const std::function<Vec3(float u, float v)>& p);
// The same from the points themselves, one for each pair of lines, u running fastest.
MeshDescription grid_mesh(const GridLines& lines, std::vector<Vec3> points);

// Moves every vertex along its normal by height(position, uv) and computes the normals anew. What is closed
// stays closed if the height is the same for all vertices in one place.
void displace(MeshDescription& mesh, const std::function<float(Vec3 position, Vec2 uv)>& height);

// Unit normals, the average over adjoining triangles weighed by area. Vertices in one place share theirs.
void smooth_normals(MeshDescription& mesh);

// Adds `part` to `mesh`.
void append(MeshDescription& mesh, const MeshDescription& part);

// A round tube along a smooth path through `centers`, closed at both ends.
struct Tube {
  std::vector<Vec3> centers;
  std::vector<float> radii;  // one per centre
  int segments = 16;
  int rings = 32;
};
MeshDescription tube_mesh(const Tube& tube);

}  // namespace tessera::modelling
