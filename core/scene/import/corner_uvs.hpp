// SPDX-License-Identifier: Apache-2.0
// Texture coordinates for meshes without any, by the corners of each triangle. Stateless; thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/math/vec3.hpp"
#include "core/scene/description.hpp"

namespace tessera::core {

// Values of vertices become those at the corners of all triangles, one after the other. Indices must name
// values, unless there are none.
template <typename T>
void give_to_corners(std::vector<T>& values, const MeshDescription& mesh) {
  if (values.empty()) return;
  std::vector<T> own;
  own.reserve(3 * mesh.triangles.size());
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle) own.push_back(values[vertex]);
  values = std::move(own);
}

using CornerUvs = std::array<Vec2, 3>;

// Gives each triangle its own vertices, which have the positions, normals, tangents and colours of its
// corners, and these texture coordinates. Indices must name vertices.
void give_corner_uvs(MeshDescription& mesh, const CornerUvs& uvs);

}  // namespace tessera::core
