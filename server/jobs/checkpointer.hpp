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
#include <set>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "server/farm/farm.hpp"
#include "server/film/fingerprinter.hpp"
#include "server/film/job_film.hpp"
#include "server/jobs/film_reader.hpp"
#include "server/jobs/tile_batch.hpp"
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
  core::Status write(const std::vector<farm::JobSnapshot>& changed);
  std::vector<farm::JobSnapshot> changed_jobs();
  std::vector<FilmOfJob> films();
  core::Status write_tiles();
  core::Status write(TileBatch& batch);
  // Adds the tile to the batch, if it can be read.
  void take(const FilmOfJob& film, int tile, TileBatch& batch);
  // DATA_LOSS if the store has lost samples of the tile.
  core::Result<store::TileRow> encode(const FilmOfJob& film, TakenTile& tile);
  // Read after the samples: it may know more of them than the tile has, and never fewer.
  film::Produced provenance_of(const FilmOfJob& film, int tile);
  void note_unreadable(const FilmOfJob& film, int tile, const core::Error& error);
  // The store has lost samples of the tile: they are rendered again, if the job takes results.
  void replace_lost(const FilmOfJob& film, int tile, const core::Error& error);
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
  std::mutex mutex_;  // held while a checkpoint is written
  // Found during this checkpoint; guarded by mutex_.
  std::set<std::string> held_back_;  // jobs with tiles that could not be stored: their rows wait
  core::Status unreadable_;          // why the first tile could not be read
};

}  // namespace tessera::jobs
