// SPDX-License-Identifier: Apache-2.0
// Writes changes of jobs and films to the store.
//
// The rows of jobs are copied first and written last: the store has a row that says DONE only if it has all
// samples of the job. The rows of tiles are independent of each other, so they are taken one by one and
// written in batches of bounded size. Thread-safe; blocks for the disk.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "server/farm/farm.hpp"
#include "server/film/fingerprinter.hpp"
#include "server/film/job_film.hpp"
#include "server/film/tile_row.hpp"
#include "server/jobs/film_reader.hpp"
#include "server/store/job_store.hpp"

namespace tessera::jobs {

class Checkpointer {
 public:
  Checkpointer(farm::Farm& farm, store::JobStore& store, const FilmReader& films,
               film::FilmMemory& film_memory, const film::Fingerprinter& fingerprinter)
      : farm_(farm), store_(store), films_(films), film_memory_(film_memory), fingerprinter_(fingerprinter) {}

  // Writes all changes since the last checkpoint. After an error, the next checkpoint writes again what is
  // missing.
  core::Status checkpoint();

 private:
  struct FilmOfJob {
    std::shared_ptr<const v1::Job> spec;
    std::shared_ptr<film::JobFilm> film;
  };
  // A tile that is taken from its film to be stored.
  struct TakenTile {
    int tile;
    film::TileToStore to_store;
    // All of its samples, if the store had some of them already.
    std::shared_ptr<film::TilePart> whole;
  };
  class ChangedTiles;

  std::vector<farm::JobSnapshot> changed_jobs();
  std::vector<FilmOfJob> films();
  core::Status guarded_write(const std::vector<farm::JobSnapshot>& changed);
  core::Status write(const std::vector<farm::JobSnapshot>& changed);
  core::Status write(const FilmOfJob& film);
  core::Status write_batch(const FilmOfJob& film, ChangedTiles& tiles);
  // DATA_LOSS if the store has lost samples of the tile.
  core::Result<store::TileRow> encode(const FilmOfJob& film, TakenTile& tile);
  // Read after the samples: it may know more of them than the tile has, and never fewer.
  film::Produced provenance_of(const FilmOfJob& film, int tile);
  // The store has lost the tile: it is rendered again.
  void note_damage(const FilmOfJob& film, int tile, const core::Error& error);
  void note_stored(const std::vector<farm::JobSnapshot>& stored);
  // Returns the films of finished jobs.
  std::map<std::string, std::shared_ptr<film::JobFilm>> note_revisions(
      const std::vector<farm::JobSnapshot>& stored);
  void publish_completions(const std::vector<farm::JobSnapshot>& stored);

  farm::Farm& farm_;
  store::JobStore& store_;
  const FilmReader& films_;
  film::FilmMemory& film_memory_;
  const film::Fingerprinter& fingerprinter_;
  std::mutex mutex_;                    // held while a checkpoint is written
  std::set<std::string> damaged_jobs_;  // found during this checkpoint; guarded by mutex_
};

}  // namespace tessera::jobs
