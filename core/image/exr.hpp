// SPDX-License-Identifier: Apache-2.0
// Encodes OpenEXR files. Used by encode_image; other code calls that. The decoder is in exr.cpp, too.
#pragma once

#include <string>

#include "core/base/error.hpp"
#include "core/image/image.hpp"

namespace tessera::core {

// 32-bit float R, G and B, ZIP-compressed scan lines.
Result<std::string> encode_exr(const Image& image);

}  // namespace tessera::core
