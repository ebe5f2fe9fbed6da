// SPDX-License-Identifier: Apache-2.0
// Tiles of WatchTiles as pixels. Stateless.
#pragma once

#include "core/base/error.hpp"
#include "core/film/region.hpp"
#include "core/image/image.hpp"
#include "tessera/v1/render_service.pb.h"

namespace tessera::client {

// Writes the pixels of a tile in TILE_FORMAT_RGB16F into the image of `window`, which is a part of the whole
// image. DATA_LOSS: the tile is not within the window, or its pixels are damaged.
core::Status paint_tile(const v1::TileImage& tile, const core::PixelRect& window, core::Image& image);

}  // namespace tessera::client
