// SPDX-License-Identifier: Apache-2.0
// Limits on the sizes of images: of files that are read or written, and of renders.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tessera::core {

inline constexpr int kMaxImageSidePx = 65536;
inline constexpr std::int64_t kMaxImagePixels = std::int64_t{1} << 30;

// Many HDR readers count the 12 bytes per pixel in memory in 31 bits.
inline constexpr std::int64_t kMaxHdrPixels = (std::int64_t{1} << 31) / 12;

// Whether a file of `file_bytes` can plausibly hold an image of this size. Even a black image needs a byte
// for some hundred pixels; a short file that claims many more is meant to exhaust memory.
inline bool is_plausible_size(std::int64_t width, std::int64_t height, std::size_t file_bytes) {
  if (width < 1 || height < 1 || width > kMaxImageSidePx || height > kMaxImageSidePx) return false;
  constexpr std::int64_t kAlwaysAllowed = 1 << 22, kMaxPixelsPerByte = 1024;
  return width * height <= kMaxImagePixels &&
         width * height <= kAlwaysAllowed + kMaxPixelsPerByte * static_cast<std::int64_t>(file_bytes);
}

}  // namespace tessera::core
