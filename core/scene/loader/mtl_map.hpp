// A map statement of an MTL file: options, then the name of a picture, which may have spaces in it.
// Stateless; thread-safe.
#pragma once

#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

struct MtlMap {
  std::string file;  // with '\' turned into '/'
  bool clamp = false;
  Vec2 scale{1, 1}, offset{0, 0};

  bool operator==(const MtlMap&) const = default;
};

// What follows the keyword. Checks all options of the format; those but -s, -o and -clamp have no effect
// here. Errors complete a sentence that begins with the statement's place.
Result<MtlMap> read_mtl_map(std::string_view keyword, std::string_view line);

}  // namespace tessera::core
