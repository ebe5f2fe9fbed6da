// SPDX-License-Identifier: Apache-2.0
// A tile as it lies in the store, with everything that can be wrong with it looked at.
#pragma once

#include <string>

#include "server/coordinator/job_film.hpp"

namespace tessera::coordinator {

// How many are written at once: 12 MiB encoded, at most.
inline constexpr std::size_t kTilesPerBatch = 64;

struct StoredTile {
  store::TileRow row;
  TileContent content;
};

// NOT_FOUND if the store has nothing of it. DATA_LOSS if it is not what was written, or of no tile of `grid`.
core::Result<StoredTile> read_stored_tile(store::JobStore& jobs, const std::string& job_id,
                                          const core::TileGrid& grid, int tile);

}  // namespace tessera::coordinator
