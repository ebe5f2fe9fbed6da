// SPDX-License-Identifier: Apache-2.0
#include "server/film/stored_tile.hpp"

#include <fmt/format.h>

#include <utility>

namespace tessera::film {

core::Result<StoredTile> read_stored_tile(store::JobStore& jobs, const std::string& job_id,
                                          const scheduler::JobGrid& grid, int tile, core::LayerSet layers) {
  const auto failed = [&](core::ErrorCode code, const char* how) {
    return core::fail(code, fmt::format("tile {} of job {} {}", tile, job_id, how));
  };
  if (tile < 0 || tile >= grid.tile_count())
    return failed(core::ErrorCode::kDataLoss, "is not in its images");
  auto row = jobs.tile(job_id, tile);
  if (!row) return core::fail(row.error());
  if (!*row) return failed(core::ErrorCode::kNotFound, "is not stored");
  auto content = decode_tile_row(**row, grid.rect(tile), layers);
  if (!content) return core::fail(content.error());
  return StoredTile{*std::move(*row), std::move(*content)};
}

}  // namespace tessera::film
