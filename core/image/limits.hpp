// SPDX-License-Identifier: Apache-2.0
// How large a picture the formats' readers and writers take.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tessera::core {

inline constexpr int kMaxPictureSidePx = 65536;
inline constexpr std::int64_t kMaxPicturePixels = std::int64_t{1} << 30;

// stb counts the bytes of compressed PNG in 31 bits, which may be 9/8 of its 3 bytes for each pixel. Many
// readers of HDR count the 12 bytes for each pixel in memory likewise.
inline constexpr std::int64_t kMaxPngPixels = std::int64_t{1} << 29;
inline constexpr std::int64_t kMaxHdrPixels = (std::int64_t{1} << 31) / 12;

// Whether a file of `file_bytes` may claim to hold a picture of this size. Even a black one needs a byte for
// some hundred pixels; a short file that claims many more is made to exhaust memory.
inline bool is_plausible_size(std::int64_t width, std::int64_t height, std::size_t file_bytes) {
  if (width < 1 || height < 1 || width > kMaxPictureSidePx || height > kMaxPictureSidePx) return false;
  constexpr std::int64_t kAlwaysAllowed = 1 << 22, kMaxPixelsPerByte = 1024;
  return width * height <= kMaxPicturePixels &&
         width * height <= kAlwaysAllowed + kMaxPixelsPerByte * static_cast<std::int64_t>(file_bytes);
}

}  // namespace tessera::core
