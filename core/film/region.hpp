// Which part of a render: a rectangle of pixels and a range of sample numbers, both half-open.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace tessera::core {

// Pixels [x0, x1) x [y0, y1); (0, 0) is the top left corner of the picture.
struct PixelRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  bool empty() const { return x1 <= x0 || y1 <= y0; }
  std::size_t pixel_count() const {
    return static_cast<std::size_t>(width()) * static_cast<std::size_t>(height());
  }
  bool operator==(const PixelRect&) const = default;
};

// Samples [begin, end) of every pixel.
struct SampleRange {
  std::uint32_t begin = 0, end = 0;

  std::uint32_t count() const { return end - begin; }
  // How many of them have an odd number.
  std::uint32_t odd_count() const { return end / 2 - begin / 2; }
  bool empty() const { return end <= begin; }
  bool operator==(const SampleRange&) const = default;
};

// The cutting of a picture into square tiles, numbered row by row from the top left. Tiles at the right and
// lower edges are cut short by the picture.
class TileGrid {
 public:
  TileGrid(int width, int height, int tile_px) : width_(width), height_(height), tile_px_(tile_px) {}

  int width() const { return width_; }
  int height() const { return height_; }
  int tile_px() const { return tile_px_; }
  int columns() const { return (width_ + tile_px_ - 1) / tile_px_; }
  int rows() const { return (height_ + tile_px_ - 1) / tile_px_; }
  int tile_count() const { return columns() * rows(); }

  PixelRect rect(int tile) const {
    const int x = tile % columns() * tile_px_, y = tile / columns() * tile_px_;
    return {x, y, std::min(x + tile_px_, width_), std::min(y + tile_px_, height_)};
  }

 private:
  int width_, height_, tile_px_;
};

inline constexpr int kTilePx = 64;

}  // namespace tessera::core
