// SPDX-License-Identifier: Apache-2.0
// Writes changes of jobs and films to the store.
//
// The rows of jobs are copied first and written last: the store has a row that says DONE only if it has all
// samples of the job. The rows of tiles are independent of each other, so they are copied one by one and
// written in batches of bounded size. Thread-safe; blocks for the disk.
#pragma once

#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "server/farm/farm.hpp"
#include "server/film/fingerprinter.hpp"
#include "server/store/job_store.hpp"

namespace tessera::jobs {

class Checkpointer {
 public:
  Checkpointer(farm::Farm& farm, store::JobStore& store, const film::Fingerprinter& fingerprinter)
      : farm_(farm), store_(store), fingerprinter_(fingerprinter) {}

  // Writes all changes since the last checkpoint. After an error, the next checkpoint writes again what is
  // missing.
  core::Status checkpoint();

 private:
  struct TileRef {
    std::string job_id;
    int tile;
  };
  struct TileCopy {
    core::PixelRect rect;
    std::vector<core::SampleRange> done;
    film::TileContent content;
  };

  std::vector<farm::JobSnapshot> changed_jobs();
  std::vector<TileRef> changed_tiles();
  // Empty if the job was deleted.
  std::optional<TileCopy> copy(const TileRef& ref);
  core::Status write_tiles(std::span<const TileRef> tiles);
  core::Status write(const std::vector<farm::JobSnapshot>& changed);
  void note_stored(const std::vector<farm::JobSnapshot>& stored);
  void publish_completions(const std::vector<farm::JobSnapshot>& stored);

  farm::Farm& farm_;
  store::JobStore& store_;
  const film::Fingerprinter& fingerprinter_;
  std::mutex mutex_;  // held while a checkpoint is written
};

}  // namespace tessera::jobs
