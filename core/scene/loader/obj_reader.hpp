// SPDX-License-Identifier: Apache-2.0
// An OBJ file's faces as triangles, as the file has them: in its own space, corners not yet unified into
// vertices. Made for files of ten million faces: 12 bytes for each triangle, and as many again where faces
// have texture coordinates and where they have normals. Stateless; thread-safe.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/scene/loader/obj_scanner.hpp"
#include "core/scene/loader/scene_limits.hpp"

namespace tessera::core {

inline constexpr std::uint32_t kNoMaterialName = 0xffffffffu;
inline constexpr std::size_t kMaxObjTriangles = std::size_t{1} << 30;

struct ObjFile {
  // Indices into the text's positions, uvs and normals; three for each triangle, in the order of the faces.
  // Where the face has none: -1; where no face has any: an empty list.
  struct Corners {
    std::vector<std::int32_t> positions, uvs, normals;
  };
  // Triangles that follow each other under the same "usemtl" and "s".
  struct Run {
    std::size_t first_triangle = 0;
    std::uint32_t material = kNoMaterialName;      // an index into material_names
    std::optional<std::uint32_t> smoothing_group;  // 0 for flat faces; nullopt before any "s"
  };

  ObjText text;
  Corners corners;
  std::vector<Run> runs;                    // the first begins at triangle 0
  std::vector<std::string> material_names;  // as "usemtl" calls them, each once
  std::vector<int> material_lines;          // where each is used first

  std::size_t triangle_count() const { return corners.positions.size() / 3; }
  const Run& run_of(std::size_t triangle) const;
};

// What cannot be used costs that line or that face and is told in the text's warnings. Errors are "NAME:
// what", where `name` is what messages call the file: INVALID_ARGUMENT where hardly a face is left,
// RESOURCE_EXHAUSTED as soon as there are too many triangles.
Result<ObjFile> read_obj(std::string_view bytes, const std::string& name, const SceneLimit& triangles = {});

}  // namespace tessera::core
