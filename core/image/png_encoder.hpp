// SPDX-License-Identifier: Apache-2.0
// Encodes PNG files row by row; other code calls write_image (encode.hpp). The decoder is in png_codec.cpp.
#pragma once

#include <cstdint>

#include "core/base/error.hpp"
#include "core/image/display.hpp"
#include "core/image/encode.hpp"

namespace tessera::core {

// 8-bit sRGB codes of the displayed light. Needs memory for a few rows. Returns the size of the file.
Result<std::uint64_t> write_png(const RowSource& source, const DisplaySettings& display, ByteSink& sink);

// The same with alpha. The first channels must be R, G, B and A; PNG wants colours that A does not multiply.
Result<std::uint64_t> write_png_with_alpha(const ChannelRows& source, const DisplaySettings& display,
                                           ByteSink& sink);

}  // namespace tessera::core
