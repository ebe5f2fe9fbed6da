// SPDX-License-Identifier: Apache-2.0
// Encodes OpenEXR files. Used by write_image; other code calls that. The decoder is in exr.cpp, too.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"
#include "core/image/encode.hpp"

namespace tessera::core {

// 32-bit float channels, ZIP-compressed scan lines. Returns the size of the file. May throw std::bad_alloc.
Result<std::uint64_t> write_exr(const ChannelRows& source, ByteSink& sink);
// As image_layers() of codecs.hpp, of a file of this format.
Result<std::vector<std::string>> exr_layers(std::string_view bytes);
// R, G and B.
Result<std::uint64_t> write_exr(const RowSource& source, ByteSink& sink);

}  // namespace tessera::core
