// SPDX-License-Identifier: Apache-2.0
#include "core/view/tile_rows.hpp"

#include <algorithm>

#include "core/view/tile_pixels.hpp"

namespace tessera::view {

core::RowSource TileRows::rows(int image_width, int image_height) {
  core::RowSource rows{.width = region_.width(), .height = region_.height(), .row = {}};
  rows.row = [this](int y) -> core::Result<const core::Rgb*> {
    const int tile_row = (region_.y0 + y - grid_.window().y0) / grid_.tile_px();
    if (tile_row != tile_row_) {
      if (auto read = read_band(tile_row); !read) return core::fail(read.error());
    }
    return &band_.at(0, region_.y0 + y - grid_.rect(tile_row * grid_.columns()).y0);
  };
  if (region_ != core::PixelRect{0, 0, image_width, image_height})
    rows.position = core::RowSource::Position{region_.x0, region_.y0, image_width, image_height};
  return rows;
}

core::Status TileRows::read_band(int tile_row) {
  const int first = tile_row * grid_.columns();
  band_ = core::Image(region_.width(), grid_.rect(first).height());
  for (int tile = first; tile < first + grid_.columns(); ++tile) {
    const core::PixelRect rect = grid_.rect(tile);
    const int x0 = std::max(rect.x0, region_.x0), x1 = std::min(rect.x1, region_.x1);
    if (x0 >= x1) continue;
    const auto read = source_.read({0, tile});
    if (!read) return core::fail(read.error());
    const core::Image pixels = layer_ ? develop_layer(read->layers, *layer_, rect, read->sums, 0)
                                      : develop_level(rect, read->sums, 0);
    for (int y = 0; y < rect.height(); ++y)
      for (int x = x0; x < x1; ++x) band_.at(x - region_.x0, y) = pixels.at(x - rect.x0, y);
  }
  tile_row_ = tile_row;
  return {};
}

}  // namespace tessera::view
