// SPDX-License-Identifier: Apache-2.0
// Numbers about pixels and tiles. Pure functions, and functions of a source.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/view/encoded_tiles.hpp"
#include "core/view/shown_layer.hpp"
#include "core/view/tile_source.hpp"

namespace tessera::view {

// The relative standard error of a tile: the root mean square of its pixels' standard errors, divided by
// their mean. Nothing while it cannot be estimated, and for a black tile.
std::optional<float> relative_noise(const core::Film::TileSums& sums);

struct PixelValue {
  int x = 0, y = 0;  // in the whole image
  core::Rgb value;
  std::uint32_t samples = 0;
  core::Rgb standard_error;
  // Of a layer, besides those of the beauty.
  std::optional<LayerValues> layer{};
};

// OUT_OF_RANGE if the pixel is not in the image, INVALID_ARGUMENT if that has no such layer.
core::Result<PixelValue> read_pixel(TileSource& source, int x, int y, const ShownLayer& layer = {});
// {"x":..,"y":..,"value":[r,g,b],"samples":..,"standard_error":[r,g,b]}, and of a layer
// "layer":{"channels":[..], "values":[..]}, in which numbers that are not finite are null.
std::string to_json(const PixelValue& pixel);

struct TileState {
  std::uint32_t samples = 0;
  std::optional<float> noise;
};

// Of each tile of the image. Empty for those that there is no time for: what was read before is kept in
// `tiles`, so that the next call comes further.
core::Result<std::vector<std::optional<TileState>>> read_tile_states(
    TileSource& source, EncodedTiles& tiles, std::chrono::steady_clock::time_point deadline);

}  // namespace tessera::view
