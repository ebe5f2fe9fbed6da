// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/ply_triangles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>

#include "core/scene/loader/polygon.hpp"

namespace tessera::core {

void PlyTriangles::leave_out(const PlyRow& row, std::string_view kind, std::string_view why) {
  const std::string text = fmt::format("face {} {}", row.number, why);
  if (first_left_out_.empty()) first_left_out_ = text;
  file_.warnings.add(
      kind, 0, [&] { return text + "; it is left out"; }, 1, "faces");
}

void PlyTriangles::tell_missing_uvs(const PlyRow& row) {
  const std::size_t uvs = corner_uvs_.corner_count();
  if (uvs == 0 || uvs >= row.corners.size()) return;
  const auto text = [&] {
    return fmt::format("face {} has {} texture coordinates for {} corners; the others are 0 0", row.number,
                       uvs, row.corners.size());
  };
  file_.warnings.add("texcoord", 0, text, 1, "faces");
}

Status PlyTriangles::add_face(const PlyRow& row) {
  tell_missing_uvs(row);
  const std::size_t vertices = file_.mesh.positions.size();
  const bool names_missing_vertex =
      std::ranges::any_of(row.corners, [&](std::uint32_t corner) { return corner >= vertices; });
  if (row.corners.size() < 3) {
    leave_out(row, "corners", fmt::format("must have at least 3 corners, got {}", row.corner_count));
  } else if (names_missing_vertex) {
    leave_out(row, "missing vertex",
              fmt::format("names a vertex that is not there: the file has {}, counted from 0", vertices));
  } else if (row.corners.size() > 3) {
    return add_polygon(row);
  } else {
    return add_face_triangle(row, {0, 1, 2});
  }
  return {};
}

Status PlyTriangles::add_polygon(const PlyRow& row) {
  outline_.clear();
  for (const std::uint32_t corner : row.corners) outline_.push_back(file_.mesh.positions[corner]);
  polygon_.clear();
  if (!triangulate(outline_, polygon_))
    leave_out(row, "concave",
              fmt::format("has {} corners and too many notches; split it", row.corners.size()));
  for (const auto& triangle : polygon_)
    if (auto added = add_face_triangle(row, triangle); !added) return added;
  return {};
}

Status PlyTriangles::add_face_triangle(const PlyRow& row, const std::array<std::uint32_t, 3>& corners) {
  const auto& [a, b, c] = corners;
  corner_uvs_.add_triangle(file_.mesh.triangles.size(), corners);
  return add_triangle(row.corners[a], row.corners[b], row.corners[c]);
}

Status PlyTriangles::add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const std::uint64_t most = std::min<std::uint64_t>(limit_.most, kMaxObjTriangles);
  if (file_.mesh.triangles.size() >= most)
    return fail(ErrorCode::kResourceExhausted,
                fmt::format("has more than the {} triangles that a scene may have here{}", most,
                            limit_.option.empty() ? "" : fmt::format(" ({})", limit_.option)));
  file_.mesh.triangles.push_back({a, b, c});
  return {};
}

Status PlyTriangles::add_strips(const std::vector<std::uint32_t>& corners) {
  std::size_t begin = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (corners[i] == kNoPlyVertex) {
      begin = i + 1;
    } else if (i >= begin + 2) {
      const bool is_turned = (i - begin) % 2 != 0;
      const auto added =
          add_triangle(corners[is_turned ? i - 1 : i - 2], corners[is_turned ? i - 2 : i - 1], corners[i]);
      if (!added) return added;
    }
  }
  return {};
}

}  // namespace tessera::core
