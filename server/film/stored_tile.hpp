// SPDX-License-Identifier: Apache-2.0
// Reads a tile from the store and checks it fully.
#pragma once

#include <string>

#include "server/film/tile_row.hpp"

namespace tessera::film {

// How many tiles are written at once, and how large they are together, but for the last: without layers, all
// of them take at most 12 MiB.
inline constexpr std::size_t kTilesPerBatch = 64, kBytesPerBatch = std::size_t{12} << 20;

struct StoredTile {
  store::TileRow row;
  TileContent content;
};

// NOT_FOUND if the store has no samples of it. DATA_LOSS if it is damaged, or is no tile of the job.
core::Result<StoredTile> read_stored_tile(store::JobStore& jobs, const std::string& job_id,
                                          const scheduler::JobGrid& grid, int tile, core::LayerSet layers);

}  // namespace tessera::film
