// SPDX-License-Identifier: Apache-2.0
// Writes decoded textures as image files. Stateless; thread-safe.
#pragma once

#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

struct TextureFile {
  std::string bytes;
  std::string_view ending;       // "png" or "pfm"
  std::string_view color_space;  // as scene files name it; empty for floats
};

// PNG for bytes, PFM for all others. Both are read back as the same texels.
Result<TextureFile> write_texture(const TextureImage& image);

}  // namespace tessera::core
