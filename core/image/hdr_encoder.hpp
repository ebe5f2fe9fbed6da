// SPDX-License-Identifier: Apache-2.0
// Radiance HDR files from linear values; everyone else calls encode_image (encode.hpp).
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "core/image/image.hpp"

namespace tessera::core {

// Red, green and blue mantissas and their common exponent (Ward 1991). Every mantissa is rounded to the
// nearest, so that the mean of many pixels is right; readers take a mantissa for its value, without adding a
// half. What is negative or not a number becomes 0; what is too large becomes the largest value.
std::array<std::uint8_t, 4> encode_rgbe(Rgb color);

// Rows from the top down, each packed by channel where the format allows that.
std::string encode_hdr(const Image& image);

}  // namespace tessera::core
