// SPDX-License-Identifier: Apache-2.0
// Writes changes of jobs and films to the store.
//
// A reader of the event log: it looks at jobs that have changed since the last checkpoint alone. The rows of
// jobs are copied first and written last: the store has a row that says DONE only if it has all
// samples of the job. Finished jobs then leave the memory. The rows of tiles are independent of each other,
// so they are taken one by one and written in batches of bounded size. Thread-safe; blocks for the disk.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/mutex.hpp"
#include "server/blobs/scene_files.hpp"
#include "server/farm/farm.hpp"
#include "server/film/fingerprinter.hpp"
#include "server/film/job_film.hpp"
#include "server/film/tile_row.hpp"
#include "server/jobs/checkpoint_stats.hpp"
#include "server/jobs/film_reader.hpp"
#include "server/jobs/tile_batch.hpp"
#include "server/store/job_store.hpp"

namespace tessera::jobs {

class Checkpointer {
 public:
  Checkpointer(farm::Farm& farm, store::JobStore& store, blobs::SceneFiles& files, const FilmReader& films,
               film::FilmMemory& film_memory, const film::Fingerprinter& fingerprinter)
      : farm_(farm),
        store_(store),
        files_(files),
        films_(films),
        film_memory_(film_memory),
        fingerprinter_(fingerprinter) {}

  // Writes all changes since the last checkpoint. After an error, the next checkpoint writes again what is
  // missing.
  core::Status checkpoint();
  const CheckpointStats& stats() const { return stats_; }

 private:
  core::Status checkpoint_now() TESSERA_REQUIRES(mutex_);
  core::Status write(const std::vector<farm::JobSnapshot>& changed) TESSERA_REQUIRES(mutex_);
  // Adds the jobs that changed since the last checkpoint to pending_.
  void read_events() TESSERA_REQUIRES(mutex_);
  // The pending jobs whose rows must be written.
  std::vector<farm::JobSnapshot> changed_jobs() TESSERA_REQUIRES(mutex_);
  // The films of pending jobs.
  std::vector<FilmOfJob> films() TESSERA_REQUIRES(mutex_);
  core::Status write_tiles() TESSERA_REQUIRES(mutex_);
  core::Status write(TileBatch& batch);
  // Adds the tile to the batch, if it can be read.
  void take(const FilmOfJob& film, int tile, TileBatch& batch) TESSERA_REQUIRES(mutex_);
  // DATA_LOSS if the store has lost samples of the tile.
  core::Result<store::TileRow> encode(const FilmOfJob& film, TakenTile& tile) TESSERA_REQUIRES(mutex_);
  // Read after the samples: it may know more of them than the tile has, and never fewer.
  film::Produced provenance_of(const FilmOfJob& film, int tile);
  void note_unreadable(const FilmOfJob& film, int tile, const core::Error& error) TESSERA_REQUIRES(mutex_);
  // The store has lost samples of the tile: they are rendered again, if the job takes results.
  void replace_lost(const FilmOfJob& film, int tile, const core::Error& error);
  void note_stored(const std::vector<farm::JobSnapshot>& stored) TESSERA_REQUIRES(mutex_);
  // Removes from pending_ what is stored. Jobs that are finished, stored and published leave the memory.
  core::Status settle() TESSERA_REQUIRES(mutex_);
  // Whether nothing of a job is left to do. A job that can leave the memory is added to `finished`.
  bool is_stored(const std::string& id, std::vector<farm::JobSnapshot>& finished);
  static bool is_settled(const farm::JobRecord& record);
  // Whether the job has left the memory.
  bool release(const farm::JobSnapshot& job);
  void publish_completions(const std::vector<farm::JobSnapshot>& stored);

  farm::Farm& farm_;
  store::JobStore& store_;
  blobs::SceneFiles& files_;
  const FilmReader& films_;
  film::FilmMemory& film_memory_;
  const film::Fingerprinter& fingerprinter_;
  CheckpointStats stats_;
  core::Mutex mutex_;  // held while a checkpoint is written
  events::Cursor cursor_ TESSERA_GUARDED_BY(mutex_);
  std::set<std::string> pending_ TESSERA_GUARDED_BY(mutex_);  // jobs that may have something to store
  film::TileContent content_ TESSERA_GUARDED_BY(mutex_);      // of the last tile: its memory is used again
  // Found during this checkpoint:
  // Jobs with tiles that could not be stored: their rows wait.
  std::set<std::string> held_back_ TESSERA_GUARDED_BY(mutex_);
  core::Status unreadable_ TESSERA_GUARDED_BY(mutex_);  // why the first tile could not be read
};

}  // namespace tessera::jobs
