// SPDX-License-Identifier: Apache-2.0
// The rows of an image, developed tile by tile, for files of images of any size. Not thread-safe.
#pragma once

#include <vector>

#include "core/base/error.hpp"
#include "core/image/encode.hpp"
#include "core/view/tile_source.hpp"

namespace tessera::view {

class TileRows {
 public:
  // `region`: of the window of `grid`, which is the source's. Both must outlive this object.
  TileRows(TileSource& source, const core::TileGrid& grid, const core::PixelRect& region)
      : source_(source), grid_(grid), region_(region) {}

  // For write_image(); `image_width` and `image_height` are those of the whole image. A part of the window
  // says where it lies; all of it is an image of its own, as files of a render are.
  core::RowSource rows(int image_width, int image_height);

 private:
  core::Status read_band(int tile_row);

  TileSource& source_;
  const core::TileGrid& grid_;
  const core::PixelRect region_;
  int tile_row_ = -1;  // that is in band_
  core::Image band_;   // of the region's width
};

}  // namespace tessera::view
