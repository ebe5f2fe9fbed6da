// SPDX-License-Identifier: Apache-2.0
// Turns the corners in rows of PLY files into triangles. Not thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/math/vec3.hpp"
#include "core/scene/loader/mesh_file.hpp"
#include "core/scene/loader/obj_reader.hpp"
#include "core/scene/loader/ply_corner_uvs.hpp"

namespace tessera::core {

// A corner that is no vertex, for any number of vertices.
inline constexpr std::uint32_t kNoPlyVertex = std::numeric_limits<std::uint32_t>::max();

// The corners of a face, or of strips.
struct PlyRow {
  std::uint64_t number = 0;       // from 1, within its element
  std::int64_t corner_count = 0;  // as written
  std::vector<std::uint32_t> corners{};
};

class PlyTriangles {
 public:
  // Adds to the file's mesh and warnings, and to the coordinates of corners. All must outlive this object.
  PlyTriangles(MeshFile& file, PlyCornerUvs& corner_uvs, const SceneLimit& limit)
      : file_(file), corner_uvs_(corner_uvs), limit_(limit) {}

  // Faces that cannot be used are left out with a warning. Errors: there are more triangles than the limit.
  Status add_face(const PlyRow& row);
  // kNoPlyVertex begins another strip. Every second triangle is turned around. Errors as above.
  Status add_strips(const std::vector<std::uint32_t>& corners);

  // Which face was left out first, and why; empty if none was.
  const std::string& first_left_out() const { return first_left_out_; }

 private:
  void tell_missing_uvs(const PlyRow& row);
  // `why` describes the face.
  void leave_out(const PlyRow& row, std::string_view kind, std::string_view why);
  Status add_polygon(const PlyRow& row);
  // By the numbers of corners within the face.
  Status add_face_triangle(const PlyRow& row, const std::array<std::uint32_t, 3>& corners);
  Status add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);

  MeshFile& file_;
  PlyCornerUvs& corner_uvs_;
  const SceneLimit& limit_;
  std::string first_left_out_;
  // Of one polygon; kept to reuse their memory.
  std::vector<Vec3> outline_;
  std::vector<std::array<std::uint32_t, 3>> polygon_;
};

}  // namespace tessera::core
