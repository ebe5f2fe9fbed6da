// SPDX-License-Identifier: Apache-2.0
// Parts of a render: a rectangle of pixels and a range of sample numbers, both half-open.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace tessera::core {

// Pixels [x0, x1) x [y0, y1); (0, 0) is the top left corner of the image.
struct PixelRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  bool empty() const { return x1 <= x0 || y1 <= y0; }
  std::size_t pixel_count() const {
    return static_cast<std::size_t>(width()) * static_cast<std::size_t>(height());
  }
  bool contains(const PixelRect& other) const {
    return x0 <= other.x0 && other.x1 <= x1 && y0 <= other.y0 && other.y1 <= y1;
  }
  bool operator==(const PixelRect&) const = default;
};

// Samples [begin, end) of every pixel.
struct SampleRange {
  std::uint32_t begin = 0, end = 0;

  std::uint32_t count() const { return end - begin; }
  // The number of odd sample numbers in the range.
  std::uint32_t odd_count() const { return end / 2 - begin / 2; }
  bool empty() const { return end <= begin; }
  bool operator==(const SampleRange&) const = default;
};

// Divides a window of an image into square tiles, numbered row by row from the window's top left. Tiles at
// its right and lower edges are clipped. Coordinates are those of the whole image, which the window may
// cover entirely.
class TileGrid {
 public:
  // `window` must not be empty.
  constexpr TileGrid(PixelRect window, int tile_px) : window_(window), tile_px_(tile_px) {}
  // A grid over the whole image.
  constexpr TileGrid(int width, int height, int tile_px) : TileGrid({0, 0, width, height}, tile_px) {}

  const PixelRect& window() const { return window_; }
  int width() const { return window_.width(); }
  int height() const { return window_.height(); }
  int tile_px() const { return tile_px_; }
  int columns() const { return (width() + tile_px_ - 1) / tile_px_; }
  int rows() const { return (height() + tile_px_ - 1) / tile_px_; }
  int tile_count() const { return columns() * rows(); }

  PixelRect rect(int tile) const {
    const int x = window_.x0 + tile % columns() * tile_px_, y = window_.y0 + tile / columns() * tile_px_;
    return {x, y, std::min(x + tile_px_, window_.x1), std::min(y + tile_px_, window_.y1)};
  }
  // The tile that contains this pixel, which must lie in the window.
  int tile_at(int x, int y) const {
    return (y - window_.y0) / tile_px_ * columns() + (x - window_.x0) / tile_px_;
  }
  bool operator==(const TileGrid&) const = default;

 private:
  PixelRect window_;
  int tile_px_;
};

inline constexpr int kTilePx = 64;

}  // namespace tessera::core
