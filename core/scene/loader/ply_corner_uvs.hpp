// SPDX-License-Identifier: Apache-2.0
// Texture coordinates of the corners of PLY faces, as MeshLab and Metashape write them beside those of
// vertices: "property list uchar float texcoord". Not thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/math/vec3.hpp"
#include "core/scene/description.hpp"
#include "core/scene/loader/ply_header.hpp"
#include "core/scene/loader/ply_values.hpp"

namespace tessera::core {

class PlyCornerUvs {
 public:
  static bool is_list_of(const PlyProperty& property) {
    return property.is_list && property.name == "texcoord";
  }

  // Forgets the coordinates of the face before.
  void begin_face() { face_.clear(); }
  void read_face(const PlyProperty& property, PlyValues& values);
  // Of the face.
  std::size_t corner_count() const { return face_.size() / 2; }
  // Triangle number `triangle` of the mesh, by the numbers of its corners within the face. Corners and
  // triangles without coordinates have (0, 0).
  void add_triangle(std::size_t triangle, const std::array<std::uint32_t, 3>& corners);

  // Replaces the coordinates of the vertices, if any face has others. Vertices whose corners differ are
  // split.
  void apply(MeshDescription& mesh);

 private:
  std::vector<float> face_;
  std::vector<std::array<Vec2, 3>> of_triangles_;
};

}  // namespace tessera::core
