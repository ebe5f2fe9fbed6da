// SPDX-License-Identifier: Apache-2.0
// Encodes OpenEXR files. Used by write_image; other code calls that. The decoder is in exr.cpp, too.
#pragma once

#include <cstdint>

#include "core/base/error.hpp"
#include "core/image/encode.hpp"

namespace tessera::core {

// 32-bit float channels, ZIP-compressed scan lines. Returns the size of the file. May throw std::bad_alloc.
Result<std::uint64_t> write_exr(const ChannelRows& source, ByteSink& sink);
// R, G and B.
Result<std::uint64_t> write_exr(const RowSource& source, ByteSink& sink);

}  // namespace tessera::core
