// Turns the bytes of a PNG, JPEG or Radiance HDR file into a TextureImage. Stateless; thread-safe.
#pragma once

#include <cstdint>
#include <string_view>

#include "core/base/error.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

inline constexpr std::int64_t kMaxTexturePixels = std::int64_t{1} << 28;

// What the header of such a file says, without decoding anything.
struct TextureSize {
  int width = 0, height = 0;

  std::uint64_t pixels() const {
    return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  }
};
Result<TextureSize> texture_size(std::string_view bytes);

// 8-bit files stay bytes in `color_space`; 16-bit PNGs become linear floats; HDR values are linear whatever
// `color_space` says. Gray becomes RGB. The image has the size of its header, and decoding takes memory for
// that and no more, whatever else is in the file. Alpha is linear whatever `color_space` says; where it is 1
// everywhere, or the file has none, the image is a single texel of 1. Errors of both functions complete a
// sentence that begins with the file's name: "is not a PNG, JPEG or HDR picture".
Result<TextureImage> decode_texture_image(std::string_view bytes, ColorSpace color_space,
                                          TextureChannel channel = TextureChannel::kColor);

}  // namespace tessera::core
