// Reads the vertices of an OBJ file and checks every line of it. tinyobjloader passes over most mistakes in
// silence (a missing number is 0, a bad index is left to the caller) and converts decimals through the C
// library's pow; so its faces are taken only from a text that passed here, and its numbers not at all.
// Stateless; thread-safe.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

struct ObjText {
  struct Library {
    std::string name;  // the rest of a "mtllib" line
    int line = 0;
  };

  std::vector<Vec3> positions, normals;  // as many as "v" and "vn" lines; finite
  std::vector<Vec2> uvs;                 // "vt"
  std::vector<Library> libraries;
  std::vector<int> usemtl_lines;  // the line of every "usemtl"
  int first_face_line = 0;
};

// Accepts polygons, negative indices, all of v, v/vt, v//vn and v/vt/vn, and statements that are of no use
// here (groups, lines, points, smoothing). Errors are "NAME:LINE: what"; `name` is what they call the file.
Result<ObjText> scan_obj(std::string_view text, const std::string& name);

}  // namespace tessera::core
