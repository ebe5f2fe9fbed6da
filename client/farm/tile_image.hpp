// SPDX-License-Identifier: Apache-2.0
// Tiles of WatchTiles as pixels. Stateless.
#pragma once

#include "core/base/error.hpp"
#include "core/film/region.hpp"
#include "core/image/image.hpp"
#include "core/view/tile_pixels.hpp"
#include "tessera/v1/render_service.pb.h"

namespace tessera::client {

struct ReceivedTile {
  core::PixelRect rect;  // in pixels of the whole image
  core::Image pixels;    // of its size
};

// DATA_LOSS: the tile is not within `window`, the part of the whole image that is rendered, or its pixels are
// damaged.
core::Result<ReceivedTile> read_tile(const v1::TileImage& tile, const core::PixelRect& window,
                                     view::PixelFormat format);

// Writes the pixels of a tile in TILE_FORMAT_RGB16F into the image of `window`. Errors are those of
// read_tile().
core::Status paint_tile(const v1::TileImage& tile, const core::PixelRect& window, core::Image& image);

}  // namespace tessera::client
