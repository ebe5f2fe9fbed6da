// SPDX-License-Identifier: Apache-2.0
// The rows of an image, developed tile by tile, for files of images of any size. Not thread-safe.
#pragma once

#include <vector>

#include "core/base/error.hpp"
#include "core/image/encode.hpp"
#include "core/view/shown_layer.hpp"
#include "core/view/tile_source.hpp"

namespace tessera::view {

class TileRows {
 public:
  // `region`: of the window of `grid`, which is the source's. Both must outlive this object. The image must
  // have the layer.
  TileRows(TileSource& source, const core::TileGrid& grid, const core::PixelRect& region,
           const ShownLayer& layer = {})
      : source_(source), grid_(grid), region_(region), layer_(layer) {}

  // For write_image(); `image_width` and `image_height` are those of the whole image, of which a part says
  // where it lies.
  core::RowSource rows(int image_width, int image_height);

 private:
  core::Status read_band(int tile_row);

  TileSource& source_;
  const core::TileGrid& grid_;
  const core::PixelRect region_;
  const ShownLayer layer_;
  int tile_row_ = -1;  // that is in band_
  core::Image band_;   // of the region's width
};

}  // namespace tessera::view
