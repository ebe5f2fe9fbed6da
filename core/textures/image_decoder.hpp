// Turns the bytes of a PNG, JPEG or Radiance HDR file into a TextureImage. Stateless; thread-safe.
#pragma once

#include <string_view>

#include "core/base/error.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

inline constexpr std::int64_t kMaxTexturePixels = std::int64_t{1} << 28;

// 8-bit files stay bytes in `color_space`; 16-bit PNGs become linear floats; HDR values are linear whatever
// `color_space` says. Gray becomes RGB; opacity is dropped. Errors complete a sentence that begins with the
// file's name: "is not a PNG, JPEG or HDR picture".
Result<TextureImage> decode_texture_image(std::string_view bytes, ColorSpace color_space);

}  // namespace tessera::core
