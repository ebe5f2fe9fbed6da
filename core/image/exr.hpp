// OpenEXR files from and to memory. Used by encode_image and decode_image; everyone else calls those.
#pragma once

#include <string>
#include <string_view>

#include "core/base/error.hpp"
#include "core/image/image.hpp"

namespace tessera::core {

// 32-bit float R, G and B, ZIP-compressed scan lines.
Result<std::string> encode_exr(const Image& image);

// Any single-part file with R, G and B, or with Y alone; half, float or integer channels. Alpha and other
// channels are ignored, and so is the position of the data window.
Result<Image> decode_exr(std::string_view bytes);

}  // namespace tessera::core
