// SPDX-License-Identifier: Apache-2.0
// Encodes OpenEXR files. Used by write_image; other code calls that. The decoder is in exr.cpp, too.
#pragma once

#include <cstdint>

#include "core/base/error.hpp"
#include "core/image/encode.hpp"

namespace tessera::core {

// 32-bit float R, G and B, ZIP-compressed scan lines. Returns the size of the file.
Result<std::uint64_t> write_exr(const RowSource& source, ByteSink& sink);

}  // namespace tessera::core
