// SPDX-License-Identifier: Apache-2.0
#include "client/farm/tile_image.hpp"

#include <utility>

#include "proto/convert.hpp"

namespace tessera::client {
namespace {

// A coordinator that sends a larger one is not believed.
constexpr std::size_t kMaxTilePixels = std::size_t{1} << 20;

}  // namespace

core::Result<core::PixelRect> rect_in_window(const v1::TileImage& tile, const core::PixelRect& window) {
  const auto rect = proto::from_proto(tile.rect());
  if (!rect || !window.contains(*rect) || rect->pixel_count() > kMaxTilePixels)
    return core::fail(core::ErrorCode::kDataLoss, "a tile of the coordinator is outside the image");
  return core::PixelRect{rect->x0 - window.x0, rect->y0 - window.y0, rect->x1 - window.x0,
                         rect->y1 - window.y0};
}

core::Status paint_tile(const v1::TileImage& tile, const core::PixelRect& window, core::Image& image) {
  const auto rect = rect_in_window(tile, window);
  if (!rect) return core::fail(rect.error());
  const auto pixels =
      view::decode_pixels(tile.pixels_zlib(), rect->width(), rect->height(), view::PixelFormat::kHalf);
  if (!pixels) return core::fail(pixels.error());
  for (int y = 0; y < pixels->height; ++y)
    for (int x = 0; x < pixels->width; ++x) image.at(rect->x0 + x, rect->y0 + y) = pixels->at(x, y);
  return {};
}

}  // namespace tessera::client
