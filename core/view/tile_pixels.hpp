// SPDX-License-Identifier: Apache-2.0
// The pixels of tiles as viewers receive them. Pure functions.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/film/film.hpp"
#include "core/image/image.hpp"

namespace tessera::view {

// Pixels of level L are means over 2^L x 2^L pixels of the image, counted from the tile's top left corner. At
// the greatest level, a whole tile is one pixel.
inline constexpr int kMaxLevel = 6;

// The size of a level of an image or a tile: `pixels` / 2^level, rounded up.
constexpr int level_size(int pixels, int level) {
  return (pixels + (1 << level) - 1) >> level;
}

enum class PixelFormat {
  kHalf,  // values beyond 65504, the largest half, become 65504
  kFloat,
  kRawHalf,  // as kHalf, not compressed
};

// The means of the tile's pixels, computed from exact sums: those of level 0 are what Film::develop() gives.
// Black without samples. `rect`: the tile's pixels, no more than one tile's.
core::Image develop_level(const core::PixelRect& rect, const core::Film::TileSums& sums, int level);

// The pixels, row by row as little-endian R, G and B; as a zlib stream, unless the format is raw.
core::Result<std::string> encode_pixels(const core::Image& image, PixelFormat format);
// The same back. DATA_LOSS: the pixels are damaged, or of another number.
core::Result<core::Image> decode_pixels(const std::string& pixels, int width, int height, PixelFormat format);

// The values of all channels of a film with these layers (core::image_channels()), side by side for each
// pixel, as little-endian floats in a zlib stream; 0 without samples.
core::Result<std::string> encode_channels(core::LayerSet layers, const core::PixelRect& rect,
                                          const core::Film::TileSums& sums);
// So many values back. DATA_LOSS as above.
core::Result<std::vector<float>> decode_channels(const std::string& pixels, std::size_t count);

}  // namespace tessera::view
