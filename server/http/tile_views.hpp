// SPDX-License-Identifier: Apache-2.0
// What all who look at images share, so that each tile is read and encoded once for all of them. Thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "core/base/error.hpp"
#include "core/base/mutex.hpp"
#include "core/view/encoded_tiles.hpp"
#include "core/view/stream_budget.hpp"
#include "core/view/thumbnails.hpp"
#include "core/view/tile_stream.hpp"
#include "server/watch/tile_feed.hpp"

namespace tessera::http_api {

class TileViews {
 public:
  explicit TileViews(watch::TileFeed& feed) : feed_(feed), stream_settings_{feed.images(), budget_} {}

  // The same for all who look at this image of the job. NOT_FOUND if there is no such job, INVALID_ARGUMENT
  // if it has no such image.
  core::Result<std::shared_ptr<watch::JobTiles>> source(const std::string& job_id, std::uint32_t image);

  view::EncodedTiles& tiles() { return feed_.images(); }
  view::Thumbnails& thumbnails() { return thumbnails_; }
  const view::StreamSettings& stream_settings() const { return stream_settings_; }

 private:
  using Key = std::pair<std::string, std::uint32_t>;  // the job and the index of the image
  std::shared_ptr<watch::JobTiles> shared(const Key& key);

  watch::TileFeed& feed_;
  view::StreamBudget budget_;
  view::Thumbnails thumbnails_;
  const view::StreamSettings stream_settings_;
  core::Mutex mutex_;
  std::map<Key, std::weak_ptr<watch::JobTiles>> sources_ TESSERA_GUARDED_BY(mutex_);
};

}  // namespace tessera::http_api
