// SPDX-License-Identifier: Apache-2.0
// What the sums of a film become: the channels of an image with layers. Pure functions.
//
// Names are those of Blender's layers: R, G, B and A of the beauty, Direct.R, Indirect.R, Emit.R, Env.R,
// DiffCol.R (with G and B), Normal.X, Position.X (with Y and Z), Depth.Z, UV.U, UV.V, IndexOB.X, IndexMA.X,
// InstanceID.X, CryptoObject00.r to CryptoObject02.a (ids and coverages in turn, six of each, largest
// coverage first), the same of CryptoMaterial and CryptoAsset, "Debug Sample Count.X", and StandardError.R,
// G, B. All are means over all samples of the pixel, in which those that hit nothing count as 0 (so R, G and
// B of surfaces are premultiplied by A), but Depth and the indices, which are those of the nearest surface.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/film/film.hpp"

namespace tessera::core {

// Depth.Z of a pixel where no sample hit a surface, as in Blender.
inline constexpr float kNoDepth = 1e10f;
// Pairs of id and coverage in an image.
inline constexpr int kCryptoRanks = 6;

// The channels in the order of develop_layers(): R, G, B, then those of the layers in their order.
std::vector<std::string> image_channels(LayerSet layers);

// The values of image_channels() of each pixel of a tile, row by row, side by side. `to` has room for just
// these.
void develop_layers(LayerSet layers, const PixelRect& rect, const Film::TileSums& sums, std::span<float> to);

// The rows of an image or of a part of it, tile row by tile row, from whatever has the sums. Not thread-safe.
class LayerRows {
 public:
  using TileSource = std::function<Result<Film::TileSums>(int tile)>;
  // `region`: the pixels to develop, within the grid's window.
  LayerRows(const TileGrid& grid, const PixelRect& region, LayerSet layers, TileSource tile);

  // A row of the region, from 0: image_channels() of each pixel side by side. Valid until the next call.
  // Cheapest from the top down. Errors are those of the source.
  Result<const float*> row(int y);

 private:
  Status develop(int tile_row);

  TileGrid grid_;
  PixelRect region_;
  LayerSet layers_;
  TileSource tile_;
  std::size_t channels_;
  int tile_row_ = -1;        // the one that is developed
  std::vector<float> rows_;  // its pixels in the columns of the region
};

}  // namespace tessera::core
