// SPDX-License-Identifier: Apache-2.0
// Tiles of films on their way to the store. What does not arrive there goes back to its film. For the only
// thread that stores tiles.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "server/film/job_film.hpp"
#include "server/film/stored_tile.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::jobs {

struct FilmOfJob {
  std::shared_ptr<const v1::Job> spec;
  std::shared_ptr<film::JobFilm> film;
};

// The changed tiles of a film, one after the other.
class ChangedTiles {
 public:
  explicit ChangedTiles(film::JobFilm& film) : film_(film), all_(film.take_changed_tiles()), rest_(all_) {}
  ~ChangedTiles() { film_.put_back_changed_tiles(rest_); }
  ChangedTiles(const ChangedTiles&) = delete;
  ChangedTiles& operator=(const ChangedTiles&) = delete;

  // Absent if there is none left.
  std::optional<int> first() const { return rest_.empty() ? std::nullopt : std::optional(rest_.front()); }
  void pop() { rest_ = rest_.subspan(1); }

 private:
  film::JobFilm& film_;
  const std::vector<int> all_;
  std::span<const int> rest_;
};

// A tile that is taken from its film.
struct TakenTile {
  std::shared_ptr<film::JobFilm> film;
  int tile;
  film::TileToStore to_store;
  // All of its samples, if the store had some of them already.
  std::shared_ptr<film::TilePart> whole{};
};

class TileBatch {
 public:
  TileBatch();
  ~TileBatch();
  TileBatch(const TileBatch&) = delete;
  TileBatch& operator=(const TileBatch&) = delete;

  bool is_empty() const { return taken_.empty(); }
  bool is_full() const { return taken_.size() == film::kTilesPerBatch || row_bytes_ >= film::kBytesPerBatch; }
  const std::vector<store::TileRow>& rows() const { return rows_; }

  // Takes a tile; the batch must not be full. Null if the tile is stored already. Then its row must be added,
  // or the tile given back.
  TakenTile* take(const FilmOfJob& film, int tile);
  void add_row(store::TileRow row);
  void give_back_last() noexcept;
  // The store has all rows. Empties the batch.
  void note_stored();

 private:
  std::vector<TakenTile> taken_;
  std::vector<store::TileRow> rows_;
  std::size_t row_bytes_ = 0;
};

}  // namespace tessera::jobs
