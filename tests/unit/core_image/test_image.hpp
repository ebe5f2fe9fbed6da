// SPDX-License-Identifier: Apache-2.0
// Images for the tests of this folder.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image/image.hpp"

namespace tessera::core {

// Values between 0 and a few thousand, many of them small, as in rendered images; the same for the same
// seed.
Image random_image(int width, int height, std::uint64_t seed);

// The bits of all floats, for comparisons that tell 0 from -0.
std::vector<std::uint32_t> bits_of(const Image& image);

}  // namespace tessera::core
