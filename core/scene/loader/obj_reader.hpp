// SPDX-License-Identifier: Apache-2.0
// Reads an OBJ file's faces as triangles, in the file's space, with corners not yet merged into vertices.
// Designed for files of ten million faces: 12 bytes per triangle, plus 12 each for texture coordinates and
// normals if present. Stateless; thread-safe.
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
  // -1 if the face has none; an empty list if no face has any.
  struct Corners {
    std::vector<std::int32_t> positions, uvs, normals;
  };
  // Consecutive triangles with the same "usemtl" and "s".
  struct Run {
    std::size_t first_triangle = 0;
    std::uint32_t material = kNoMaterialName;      // an index into material_names
    std::optional<std::uint32_t> smoothing_group;  // 0 for flat faces; nullopt before any "s"
  };

  ObjText text;
  Corners corners;
  std::vector<Run> runs;                    // the first begins at triangle 0
  std::vector<std::string> material_names;  // as "usemtl" calls them, each once
  std::vector<int> material_lines;          // line of first use

  std::size_t triangle_count() const { return corners.positions.size() / 3; }
  const Run& run_of(std::size_t triangle) const;
};

// Unusable lines and faces are skipped and reported in the text's warnings. Errors are "NAME: what", where
// `name` is the file's name in messages: INVALID_ARGUMENT if hardly any face is usable, RESOURCE_EXHAUSTED
// if there are too many triangles.
Result<ObjFile> read_obj(std::string_view bytes, const std::string& name, const SceneLimit& triangles = {},
                         const WarningLimits& warnings = {});

}  // namespace tessera::core
