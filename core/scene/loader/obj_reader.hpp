// An OBJ file's faces as triangles, as the file has them: in its own space, corners not yet unified into
// vertices. Stateless; thread-safe.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/scene/loader/obj_scanner.hpp"

namespace tessera::core {

inline constexpr std::uint32_t kNoMaterialName = 0xffffffffu;

struct ObjFile {
  // Indices into the text's positions, uvs and normals; uv and normal are -1 where the face has none.
  struct Corner {
    std::int32_t position = -1, uv = -1, normal = -1;
    bool operator==(const Corner&) const = default;
  };

  ObjText text;
  std::vector<Corner> corners;                    // three for each triangle, in the order of the faces
  std::vector<std::uint32_t> triangle_materials;  // indices into material_names, or kNoMaterialName
  std::vector<std::string> material_names;        // as "usemtl" calls them, each once
  std::vector<int> material_lines;                // where each is used first
};

// Errors are "NAME:LINE: what"; `name` is what they call the file.
Result<ObjFile> read_obj(std::string_view bytes, const std::string& name);

}  // namespace tessera::core
