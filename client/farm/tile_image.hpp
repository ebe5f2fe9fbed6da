// SPDX-License-Identifier: Apache-2.0
// Tiles of WatchTiles as pixels. Stateless.
#pragma once

#include "core/base/error.hpp"
#include "core/film/region.hpp"
#include "core/image/image.hpp"
#include "core/view/tile_pixels.hpp"
#include "tessera/v1/render_service.pb.h"

namespace tessera::client {

// Where a tile lies, in pixels of `window`, the part of the whole image that is rendered. DATA_LOSS: it is
// not within that.
core::Result<core::PixelRect> rect_in_window(const v1::TileImage& tile, const core::PixelRect& window);

// Writes the pixels of a tile in TILE_FORMAT_RGB16F into the image of `window`. DATA_LOSS also if they are
// damaged.
core::Status paint_tile(const v1::TileImage& tile, const core::PixelRect& window, core::Image& image);

}  // namespace tessera::client
