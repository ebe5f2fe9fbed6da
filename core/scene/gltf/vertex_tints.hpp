// SPDX-License-Identifier: Apache-2.0
// What vertex colours do besides multiplying base colours: their alpha multiplies the opacity, and the
// colours what unlit surfaces emit and clear ones transmit. All belong to materials, so that each triangle
// has one tint, and a material for it. Stateless; thread-safe.
#pragma once

#include <cstddef>
#include <vector>

#include "core/math/rgb.hpp"
#include "core/scene/description.hpp"

namespace tessera::core::gltf {

// Multiplies the opacity of a material, and what an unlit one emits or a clear one transmits.
struct VertexTint {
  Rgb color = Rgb::gray(1);
  float alpha = 1;

  bool operator==(const VertexTint&) const = default;
};

struct TriangleTints {
  std::vector<VertexTint> tints;     // that of each triangle: the mean of its corners
  bool varies_in_triangles = false;  // corners of a triangle differ
  int steps = 0;                     // to which channels were rounded; 0 if they were not
};

inline constexpr std::size_t kMaxVertexTints = 256;
// `colors` and `alphas` are those of the mesh's vertices; empty ones do not tint. Where there are more than
// kMaxVertexTints different tints, they are rounded.
TriangleTints triangle_tints(const MeshDescription& mesh, const std::vector<Rgb>& colors,
                             const std::vector<float>& alphas);

}  // namespace tessera::core::gltf
