// SPDX-License-Identifier: Apache-2.0
// Decodes an image file of any format of core/image/codecs.hpp into a TextureImage. Stateless; thread-safe.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/image/codecs.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

inline constexpr std::int64_t kMaxTexturePixels = std::int64_t{1} << 28;

// The size from the header of an image file, without decoding.
using TextureSize = ImageSize;
Result<TextureSize> texture_size(std::string_view bytes);

// 8-bit files stay bytes in `color_space`; 16-bit files become linear floats; float and HDR files are
// always linear, and kSrgb converts colours whose file names other primaries than those of sRGB. Gray becomes
// RGB. NaN and negative values become 0, infinite ones the largest half float.
// The image has the size in its header. Alpha is always linear; if it is 1 everywhere, or the file has
// none, the image is a single texel of 1. Errors of both functions complete a sentence that begins with the
// file's name: "is a GIF image, which is not supported; save it as PNG". `warnings`, if not null, gets
// similar sentences for oddities that were tolerated. `layer` is that of DecodeOptions, whose channels are
// read as red, green and blue; it has no alpha.
Result<TextureImage> decode_texture_image(std::string_view bytes, ColorSpace color_space,
                                          TextureChannel channel = TextureChannel::kColor,
                                          std::vector<std::string>* warnings = nullptr,
                                          std::string_view layer = {});

}  // namespace tessera::core
