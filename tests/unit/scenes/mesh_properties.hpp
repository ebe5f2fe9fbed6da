// SPDX-License-Identifier: Apache-2.0
// What tests ask of meshes.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>

#include "core/scene/description.hpp"

namespace tessera::modelling {

// How many edges do not belong to exactly two triangles that run along them in opposite directions, vertices
// in one place counting as one. 0 for closed surfaces.
inline int open_edge_count(const core::MeshDescription& mesh) {
  using Place = std::tuple<float, float, float>;
  const auto place = [&](std::uint32_t i) {
    return Place{mesh.positions[i].x, mesh.positions[i].y, mesh.positions[i].z};
  };
  std::map<std::pair<Place, Place>, int> uses;
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) ++uses[{place(t[i]), place(t[(i + 1) % 3])}];
  }
  int open = 0;
  for (const auto& [edge, count] : uses) {
    const auto opposite = uses.find({edge.second, edge.first});
    if (count != 1 || opposite == uses.end() || opposite->second != 1) ++open;
  }
  return open;
}

// Of a closed mesh; positive if its triangles are counter-clockwise seen from outside.
inline double enclosed_volume(const core::MeshDescription& mesh) {
  double six_volumes = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    six_volumes += dot(mesh.positions[a], cross(mesh.positions[b], mesh.positions[c]));
  }
  return six_volumes / 6;
}

}  // namespace tessera::modelling
