// SPDX-License-Identifier: Apache-2.0
// The first of two passes over an OBJ file: reads its vertices and checks every statement except faces,
// which may refer to later vertices. Stateless; thread-safe.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/geometry/surface.hpp"
#include "core/math/rgb.hpp"
#include "core/math/vec3.hpp"
#include "core/scene/loader/file_warnings.hpp"

namespace tessera::core {

struct ObjText {
  struct Library {
    std::string name;  // the rest of a "mtllib" line
    int line = 0;
  };
  struct BrokenVertex {
    std::int32_t position;
    int line;
  };

  std::vector<Vec3> positions;  // as many as "v" lines; not finite where the line has no 3 finite numbers
  std::vector<BrokenVertex> broken_vertices;  // those not finite, in their order
  std::vector<Vec3> normals;                  // "vn"; finite, and 0 for one that is none
  std::vector<Vec2> uvs;                      // "vt"; finite
  std::vector<Vec2> second_uvs;               // beside `uvs`, of other formats; or empty
  std::vector<Rgb> colors;                    // linear, one per position; empty if no vertex has one
  std::vector<VertexTangent> tangents;        // one per position, of other formats; or empty
  std::vector<Library> libraries;
  int first_face_line = 0;
  std::size_t face_count = 0;  // at least 1
  FileWarnings warnings;
};

// Whether a statement is a face: "f", or "fo" in old files.
bool is_face(std::string_view keyword);

// Lines that cannot be parsed are skipped with a warning. Fails only if there are no faces: "NAME: what",
// where `name` is the file's name in messages.
Result<ObjText> scan_obj(std::string_view text, const std::string& name, const WarningLimits& warnings = {});

}  // namespace tessera::core
