// SPDX-License-Identifier: Apache-2.0
#include "server/jobs/tile_batch.hpp"

#include <utility>

namespace tessera::jobs {

TileBatch::TileBatch() {
  taken_.reserve(film::kTilesPerBatch);
  rows_.reserve(film::kTilesPerBatch);
}

TileBatch::~TileBatch() {
  while (!taken_.empty()) give_back_last();
}

TakenTile* TileBatch::take(const FilmOfJob& film, int tile) {
  auto to_store = film.film->begin_store(tile);
  if (!to_store) return nullptr;
  return &taken_.emplace_back(TakenTile{film.film, tile, *std::move(to_store)});
}

void TileBatch::add_row(store::TileRow row) {
  row_bytes_ += row.content.size();
  rows_.push_back(std::move(row));
}

void TileBatch::give_back_last() noexcept {
  const TakenTile& last = taken_.back();
  last.film->not_stored(last.tile, last.to_store);
  taken_.pop_back();
}

void TileBatch::note_stored() {
  for (TakenTile& each : taken_)
    each.film->stored(each.tile, std::move(each.to_store), std::move(each.whole));
  taken_.clear();
  rows_.clear();
  row_bytes_ = 0;
}

}  // namespace tessera::jobs
