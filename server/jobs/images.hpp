// SPDX-License-Identifier: Apache-2.0
// Develops the images of jobs, finished or not. Thread-safe; blocks for the disk where films are stored.
#pragma once

#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/film/film.hpp"
#include "core/image/image.hpp"
#include "server/farm/farm.hpp"
#include "server/farm/state_lock.hpp"
#include "server/jobs/film_reader.hpp"

namespace tessera::jobs {

struct JobImage {
  v1::Job job;  // when copying of the image began, without its bundle
  core::Image image;
};

class Images {
 public:
  Images(farm::Farm& farm, const FilmReader& films) : farm_(farm), films_(films) {}

  // Copies the image tile by tile, and holds the state lock for a few tiles at a time. Tiles of a running job
  // may show different moments; those of a done job are all complete.
  core::Result<JobImage> get(const std::string& id);

 private:
  core::Result<v1::Job> describe(const std::string& id);
  core::Result<JobImage> develop(const std::string& id);
  core::Result<core::Image> develop_row(const v1::Job& spec, const core::TileGrid& grid, int row);
  // Copies the tiles from `begin` to `end` from the film while holding the state lock, or else from the
  // store.
  core::Result<std::vector<core::Film::TileSums>> copy_tiles(const v1::Job& spec, const core::TileGrid& grid,
                                                             int begin, int end);

  farm::Farm& farm_;
  const FilmReader& films_;
};

}  // namespace tessera::jobs
