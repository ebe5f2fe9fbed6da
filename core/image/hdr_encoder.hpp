// SPDX-License-Identifier: Apache-2.0
// Encodes Radiance HDR files from linear values; other code calls write_image (encode.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "core/math/rgb.hpp"

namespace tessera::core {

// Red, green and blue mantissas and their shared exponent (Ward 1991). Mantissas are rounded to nearest, so
// the mean of many pixels is unbiased; readers do not add one half. Negative values and NaN become 0;
// values out of range become the largest value.
std::array<std::uint8_t, 4> encode_rgbe(Rgb color);

// A file is its header and then its rows from the top down, each packed by channel where the format allows
// that.
std::string hdr_file_header(int width, int height);
void append_hdr_row(std::span<const Rgb> pixels, std::string& file);

}  // namespace tessera::core
