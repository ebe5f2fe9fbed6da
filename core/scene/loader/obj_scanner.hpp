// The first of two passes over an OBJ file: reads its vertices and checks every statement but faces, which
// may refer to vertices that come later. Stateless; thread-safe.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

struct ObjText {
  struct Library {
    std::string name;  // the rest of a "mtllib" line, with '\' turned into '/'
    int line = 0;
  };

  std::vector<Vec3> positions, normals;  // as many as "v" and "vn" lines; finite
  std::vector<Vec2> uvs;                 // "vt"
  std::vector<Library> libraries;
  int first_face_line = 0;
  std::size_t face_count = 0;  // at least 1
};

// Whether a statement is a face: "f", or "fo" of old files.
bool is_face(std::string_view keyword);

// Passes over statements that are of no use here (groups, lines, points). Errors are "NAME:LINE: what";
// `name` is what they call the file.
Result<ObjText> scan_obj(std::string_view text, const std::string& name);

}  // namespace tessera::core
