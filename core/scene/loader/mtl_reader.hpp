// The materials of an MTL file, as this renderer understands them (docs/scene-format.md has the table).
// Stateless; thread-safe.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/materials/material.hpp"

namespace tessera::core {

struct MtlMaterial {
  Material material;
  // map_Kd, with slashes as written but for '\', which becomes '/'; empty for none. Relative to the MTL file.
  // It multiplies Lambert's albedo or Phong's diffuse part.
  std::string albedo_file;
  int albedo_line = 0;
  Wrap wrap = Wrap::kRepeat;
  Vec2 scale{1, 1}, offset{0, 0};
};

// Passes over statements that have no meaning here. Errors are "NAME:LINE: what"; `name` is what they call
// the file.
Result<std::vector<MtlMaterial>> read_mtl(std::string_view bytes, const std::string& name);

}  // namespace tessera::core
