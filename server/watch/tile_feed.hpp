// SPDX-License-Identifier: Apache-2.0
// The tiles of a job's image that have changed since some revision. Thread-safe; blocks for the disk where
// samples are stored.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "server/farm/farm.hpp"
#include "server/film/job_film.hpp"
#include "server/jobs/film_reader.hpp"
#include "server/jobs/job_service.hpp"
#include "server/store/job_store.hpp"
#include "server/watch/tile_images.hpp"

namespace tessera::watch {

struct TileQuery {
  std::string job_id;
  events::Revision since = 0;
  v1::TileFormat format = v1::TILE_FORMAT_RGB16F;
  // Only tiles that it touches; in pixels of the whole image.
  std::optional<core::PixelRect> region{};
  // Tiles are added up to this size, and one at least.
  std::size_t max_bytes = 0;
};

struct TileUpdate {
  v1::Job job;  // before the tiles were read; without its bundle
  std::vector<v1::TileImage> tiles;
  // All changes up to here are in this update or an earlier one.
  events::Revision revision = 0;
  // There was nothing more at this moment.
  bool is_current = true;
};

class TileFeed {
 public:
  TileFeed(farm::Farm& farm, jobs::JobService& jobs, const jobs::FilmReader& films, store::JobStore& store)
      : farm_(farm), jobs_(jobs), films_(films), store_(store), images_(kCacheBytes) {}

  // INVALID_ARGUMENT: the format is unknown, or the region is not within the pixels of the job.
  core::Result<TileUpdate> update(const TileQuery& query);

  const TileImages& images() const { return images_; }

 private:
  // The tiles of a 4K image as single floats, twice.
  static constexpr std::size_t kCacheBytes = 256 << 20;

  // Null if the film is in the store alone.
  std::shared_ptr<film::JobFilm> film_of(const std::string& job_id);
  core::Result<std::vector<film::TileEvent>> changes(const TileQuery& query, const film::JobFilm* film,
                                                     events::Revision since);
  core::Result<std::shared_ptr<const EncodedTile>> encoded(const TileQuery& query, const v1::Job& job,
                                                           const std::shared_ptr<film::JobFilm>& film,
                                                           const film::TileEvent& change);

  farm::Farm& farm_;
  jobs::JobService& jobs_;
  const jobs::FilmReader& films_;
  store::JobStore& store_;
  TileImages images_;
};

}  // namespace tessera::watch
