// SPDX-License-Identifier: Apache-2.0
// Develops the images of jobs, finished or not. Thread-safe; blocks for the disk where films are stored.
#pragma once

#include <memory>
#include <string>

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

  // Copies the image tile by tile, without the state lock. Tiles of a running job may show different moments;
  // those of a done job are all complete.
  core::Result<JobImage> get(const std::string& id);

 private:
  struct Source {
    v1::Job job;
    std::shared_ptr<film::JobFilm> film;  // null if the store alone has it
  };

  core::Result<Source> find(const std::string& id);
  core::Result<JobImage> develop(const std::string& id);
  core::Result<core::Image> develop_row(const Source& source, const core::TileGrid& grid, int row);

  farm::Farm& farm_;
  const FilmReader& films_;
};

}  // namespace tessera::jobs
