// SPDX-License-Identifier: Apache-2.0
// Reads a tile from the store and checks it fully.
#pragma once

#include <string>

#include "server/film/tile_row.hpp"

namespace tessera::film {

// The number of tiles that are written at once: at most 12 MiB encoded.
inline constexpr std::size_t kTilesPerBatch = 64;

struct StoredTile {
  store::TileRow row;
  TileContent content;
};

// NOT_FOUND if the store has no samples of it. DATA_LOSS if it is damaged, or is no tile of the job.
core::Result<StoredTile> read_stored_tile(store::JobStore& jobs, const std::string& job_id,
                                          const scheduler::JobGrid& grid, int tile);

}  // namespace tessera::film
