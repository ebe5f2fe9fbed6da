// SPDX-License-Identifier: Apache-2.0
#include "client/farm/tile_image.hpp"

#include <utility>

#include "proto/convert.hpp"

namespace tessera::client {
namespace {

// A coordinator that sends a larger one is not believed.
constexpr std::size_t kMaxTilePixels = std::size_t{1} << 20;

}  // namespace

core::Result<ReceivedTile> read_tile(const v1::TileImage& tile, const core::PixelRect& window,
                                     view::PixelFormat format) {
  const auto rect = proto::from_proto(tile.rect());
  if (!rect || !window.contains(*rect) || rect->pixel_count() > kMaxTilePixels)
    return core::fail(core::ErrorCode::kDataLoss, "a tile of the coordinator is outside the image");
  auto pixels = view::decode_pixels(tile.pixels_zlib(), rect->width(), rect->height(), format);
  if (!pixels) return core::fail(pixels.error());
  return ReceivedTile{*rect, *std::move(pixels)};
}

core::Status paint_tile(const v1::TileImage& tile, const core::PixelRect& window, core::Image& image) {
  const auto read = read_tile(tile, window, view::PixelFormat::kHalf);
  if (!read) return core::fail(read.error());
  const auto& [rect, pixels] = *read;
  for (int y = 0; y < pixels.height; ++y)
    for (int x = 0; x < pixels.width; ++x)
      image.at(rect.x0 - window.x0 + x, rect.y0 - window.y0 + y) = pixels.at(x, y);
  return {};
}

}  // namespace tessera::client
