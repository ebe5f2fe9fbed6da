// SPDX-License-Identifier: Apache-2.0
// A map statement of an MTL file: options, then the name of an image, which may have spaces in it.
// Stateless; thread-safe.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/math/vec3.hpp"
#include "core/scene/loader/file_warnings.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

struct MtlMap {
  std::string file;  // as written
  bool clamp = false;
  Vec2 scale{1, 1}, offset{0, 0};
  float bump_multiplier = 1;                        // -bm
  TextureChannel channel = TextureChannel::kColor;  // -imfchan, of maps of numbers
  int line = 0;

  bool operator==(const MtlMap&) const = default;
};

// Parses the text after the keyword; nullopt if no image is named. Only -s, -o, -clamp, -bm and -imfchan
// have an effect. Unknown options are ignored with a warning.
std::optional<MtlMap> read_mtl_map(std::string_view keyword, std::string_view line, int line_number,
                                   FileWarnings& warnings);

}  // namespace tessera::core
