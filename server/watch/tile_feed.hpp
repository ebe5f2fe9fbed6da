// SPDX-License-Identifier: Apache-2.0
// The tiles of an image of a job that have changed since some revision. Thread-safe; blocks for the disk
// where samples are stored.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/view/encoded_tiles.hpp"
#include "server/farm/farm.hpp"
#include "server/jobs/film_reader.hpp"
#include "server/store/job_store.hpp"
#include "server/watch/job_tiles.hpp"

namespace tessera::watch {

struct TileQuery {
  std::string job_id;
  events::Revision since = 0;
  v1::TileFormat format = v1::TILE_FORMAT_RGB16F;
  // Only tiles that it touches; in pixels of the whole image.
  std::optional<core::PixelRect> region{};
  // Tiles are added up to this size, and one at least.
  std::size_t max_bytes = 0;
  std::uint32_t image = 0;
  view::ShownLayer layer{};
};

struct TileUpdate {
  v1::Job job;  // before the tiles were read; without its bundle
  std::vector<v1::TileImage> tiles;
  // All changes up to here are in this update or an earlier one.
  events::Revision revision = 0;
  // There was nothing more at this moment.
  bool is_current = true;
  // Of TILE_FORMAT_ALL32F.
  std::vector<std::string> channels{};
};

class TileFeed {
 public:
  TileFeed(farm::Farm& farm, const jobs::FilmReader& films, store::JobStore& store)
      : farm_(farm), films_(films), store_(store), images_(kCacheBytes) {}

  // The tiles of one image of a job. All who watch it may share the source, or have their own.
  std::shared_ptr<JobTiles> tiles_of(const std::string& job_id, std::uint32_t image) {
    return std::make_shared<JobTiles>(farm_, films_, store_, job_id, image);
  }

  // INVALID_ARGUMENT: the format is unknown or does not go with the layer, the region is not within the
  // pixels of the job, or the job has no such image or layer.
  core::Result<TileUpdate> update(const TileQuery& query);

  // Those of all jobs, for others who send tiles, too.
  view::EncodedTiles& images() { return images_; }

 private:
  // The tiles of a 4K image as single floats, twice.
  static constexpr std::size_t kCacheBytes = 256 << 20;

  core::Result<std::shared_ptr<const view::EncodedTile>> encoded(const TileQuery& query,
                                                                 const JobTiles& source, const JobLook& look,
                                                                 const view::TileChange& change);

  farm::Farm& farm_;
  const jobs::FilmReader& films_;
  store::JobStore& store_;
  view::EncodedTiles images_;
};

}  // namespace tessera::watch
