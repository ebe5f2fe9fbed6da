// SPDX-License-Identifier: Apache-2.0
#include "core/scene/import/corner_uvs.hpp"

#include <cstdint>

namespace tessera::core {

void give_corner_uvs(MeshDescription& mesh, const CornerUvs& uvs) {
  give_to_corners(mesh.positions, mesh);
  give_to_corners(mesh.normals, mesh);
  give_to_corners(mesh.tangents, mesh);
  give_to_corners(mesh.colors, mesh);
  mesh.uvs.clear();
  mesh.uvs.reserve(mesh.positions.size());
  std::uint32_t vertex = 0;
  for (auto& triangle : mesh.triangles) {
    mesh.uvs.insert(mesh.uvs.end(), uvs.begin(), uvs.end());
    triangle = {vertex, vertex + 1, vertex + 2};
    vertex += 3;
  }
}

}  // namespace tessera::core
