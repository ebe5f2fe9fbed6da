// SPDX-License-Identifier: Apache-2.0
// Images that promise or hold more than is good for whoever decodes them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace tessera {

inline std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xff);
  return bytes;
}

// Without its checksum: no reader of ours looks at that.
inline std::string png_chunk(const std::string& type, const std::string& data) {
  return big_endian(static_cast<std::uint32_t>(data.size())) + type + data + std::string(4, '\0');
}

// The beginning of a gray PNG: its size, and not a pixel.
inline std::string png_header(std::uint32_t width, std::uint32_t height, int bits = 8) {
  return "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", big_endian(width) + big_endian(height) +
                                                     static_cast<char>(bits) + std::string(4, '\0'));
}

// A zlib stream (RFC 1950, 1951) of 1 + 258 * runs zeros, in a 158th of that.
inline std::string deflated_zeros(std::size_t runs) {
  std::string bytes("\x78\x01", 2);
  unsigned pending = 0;
  int count = 0;
  const auto put_bit = [&](unsigned bit) {
    pending |= bit << count;
    if (++count < 8) return;
    bytes += static_cast<char>(pending);
    pending = 0;
    count = 0;
  };
  const auto put_code = [&](unsigned code, int length) {
    for (int i = length - 1; i >= 0; --i) put_bit(code >> i & 1);
  };
  put_bit(1);         // the last block
  put_code(0b10, 2);  // with the fixed codes, of which the lower bit comes first
  put_code(0x30, 8);  // a zero
  for (std::size_t i = 0; i < runs; ++i) {
    put_code(0xc5, 8);  // the 258 bytes
    put_code(0, 5);     // that begin one byte before
  }
  put_code(0, 7);  // the end
  while (count != 0) put_bit(0);
  return bytes + std::string(4, '\0');
}

// One pixel, and compressed zeros that no pixel needs.
inline std::string png_bomb(std::size_t runs) {
  return png_header(1, 1) + png_chunk("IDAT", deflated_zeros(runs)) + png_chunk("IEND", "");
}

}  // namespace tessera
