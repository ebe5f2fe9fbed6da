// SPDX-License-Identifier: Apache-2.0
// Tiles as rows of the store. Pure functions.
#pragma once

#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/film/film.hpp"
#include "server/film/tile_provenance.hpp"
#include "server/store/job_store.hpp"

namespace tessera::film {

// The content of one tile.
struct TileContent {
  core::Film::TileSums sums;
  core::RenderCounters counters;
  // The producers of the samples; filled in only when read from the store. While a job runs, the scheduler
  // has them.
  Produced provenance{};
};

// Converts a tile to a row of the store. `done` are the samples in it.
store::TileRow encode_tile_row(const std::string& job_id, int tile, const core::PixelRect& rect,
                               std::vector<core::SampleRange> done, const TileContent& content);
// Converts it back. DATA_LOSS if the row is not one that encode_tile_row made for this rectangle and these
// layers.
core::Result<TileContent> decode_tile_row(const store::TileRow& row, const core::PixelRect& rect,
                                          core::LayerSet layers = {});

}  // namespace tessera::film
