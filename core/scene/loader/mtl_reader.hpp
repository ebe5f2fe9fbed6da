// The materials of an MTL file, as this renderer understands them (docs/scene-format.md has the table).
// Parsing is tinyobjloader's, after a check of the statements that count here. Stateless; thread-safe.
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
  // It multiplies the albedo.
  std::string albedo_file;
  Wrap wrap = Wrap::kRepeat;
  Vec2 scale{1, 1}, offset{0, 0};
};

// Errors are "NAME:LINE: what"; `name` is what they call the file.
Result<std::vector<MtlMaterial>> read_mtl(std::string_view bytes, const std::string& name);

}  // namespace tessera::core
