// SPDX-License-Identifier: Apache-2.0
// The tiles of an image of a job wherever they are: of a job in progress in its film, of a finished one in
// the store. They are numbered within the image. Thread-safe; blocks for the disk where samples are stored.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>
#include "core/base/mutex.hpp"

#include "core/base/error.hpp"
#include "core/view/tile_source.hpp"
#include "server/farm/farm.hpp"
#include "server/film/job_film.hpp"
#include "server/jobs/film_reader.hpp"
#include "server/store/job_store.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::watch {

bool is_final(v1::JobState state);

// A job at one moment. What is read of its tiles later has at least the samples of that moment, so those of a
// done job are complete.
struct JobLook {
  v1::Job job;  // without its bundle
  scheduler::JobShape shape;
  std::shared_ptr<film::JobFilm> film;  // null if the store alone has it
};

class JobTiles final : public view::TileSource {
 public:
  JobTiles(farm::Farm& farm, const jobs::FilmReader& films, store::JobStore& store, std::string job_id,
           std::uint32_t image = 0)
      : farm_(farm), films_(films), store_(store), job_id_(std::move(job_id)), image_(image) {}

  // NOT_FOUND if there is no such job. Made anew only if anything has changed in the farm.
  core::Result<std::shared_ptr<const JobLook>> look();
  // The job must have the image, here and in the following functions.
  core::Result<std::vector<view::TileChange>> changes_since(const JobLook& look, view::Revision since,
                                                            std::size_t most) const;
  core::Result<view::TileAtRevision> read(const JobLook& look, const view::TileChange& change) const;
  // The samples that the tile is to get.
  std::uint32_t target(const JobLook& look, int tile) const { return look.shape.target(of_job(look, tile)); }

  // ---- TileSource ----
  std::string id() const override;
  core::Result<view::JobHeader> header() override;
  std::optional<core::TileGrid> grid() override;
  core::LayerSet layers() override;
  core::Result<std::vector<view::TileChange>> changes_since(view::Revision since, std::size_t most) override;
  core::Result<view::TileAtRevision> read(const view::TileChange& change) override;
  bool is_over() override;

 private:
  core::Result<std::shared_ptr<const JobLook>> look_again() const;
  // The number of a tile of the image in the job.
  int of_job(const JobLook& look, int tile) const {
    return look.shape.grid().first_tile(static_cast<int>(image_)) + tile;
  }

  farm::Farm& farm_;
  const jobs::FilmReader& films_;
  store::JobStore& store_;
  const std::string job_id_;
  const std::uint32_t image_;
  core::Mutex mutex_;
  // The last look, and the last change in the farm before it.
  std::shared_ptr<const JobLook> last_ TESSERA_GUARDED_BY(mutex_);
  events::Revision last_revision_ TESSERA_GUARDED_BY(mutex_) = 0;
  // The last look that was described, and that as JSON.
  std::shared_ptr<const JobLook> described_ TESSERA_GUARDED_BY(mutex_);
  std::string json_ TESSERA_GUARDED_BY(mutex_);
};

}  // namespace tessera::watch
