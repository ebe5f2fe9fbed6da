// SPDX-License-Identifier: Apache-2.0
// The sRGB transfer function (IEC 61966-2-1:1999) between linear values and the encoding of PNG and JPEG
// files. It is exact, not a power of 2.2, and gives the same bytes on every machine. Stateless;
// thread-safe.
#pragma once

#include <cstdint>

namespace tessera::core {

// The correctly rounded 8-bit code of a linear value: 0 for values below 0 or NaN, 255 above 1.
std::uint8_t srgb_encode(float linear);

// The linear value of a code, in [0, 1].
float srgb_decode(std::uint8_t code);
// The linear value of an encoded value in [0, 1], as in 16-bit files.
float srgb_decode(double encoded);

}  // namespace tessera::core
