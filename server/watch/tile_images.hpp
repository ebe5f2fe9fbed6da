// SPDX-License-Identifier: Apache-2.0
// Encoded tiles, shared by all who watch an image: each revision of a tile is developed and encoded once in
// each format, however many watch, as long as the tiles that are watched fit into the budget. The least
// recently used ones are dropped. Thread-safe.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "core/base/error.hpp"
#include "core/film/film.hpp"
#include "server/events/revision.hpp"
#include "tessera/v1/render_service.pb.h"

namespace tessera::watch {

// The samples of a tile at some revision.
struct TileAtRevision {
  core::Film::TileSums sums;
  events::Revision revision = 0;
};

struct EncodedTile {
  events::Revision revision = 0;
  std::uint32_t samples = 0;
  std::string pixels_zlib;
};

class TileImages {
 public:
  explicit TileImages(std::size_t budget_bytes) : budget_bytes_(budget_bytes) {}

  struct Key {
    std::string job_id;
    int tile = 0;
    v1::TileFormat format = v1::TILE_FORMAT_UNSPECIFIED;
    auto operator<=>(const Key&) const = default;
  };
  using Read = std::function<core::Result<TileAtRevision>()>;
  // The tile at this revision or a later one. If it is not there, reads the samples and encodes them; others
  // who want the same tile meanwhile wait for that. `size`: of the tile in pixels.
  core::Result<std::shared_ptr<const EncodedTile>> get(const Key& key, events::Revision revision,
                                                       const core::PixelRect& rect, const Read& read);

  // How many tiles were encoded since the start.
  std::uint64_t encoded_tiles() const;

 private:
  struct Entry {
    std::mutex mutex;                           // held while the tile is encoded
    std::shared_ptr<const EncodedTile> tile{};  // guarded by the mutex of TileImages; null at first
    std::list<Key>::iterator used{};            // the same
  };

  std::shared_ptr<Entry> entry(const Key& key);
  std::shared_ptr<const EncodedTile> tile_of(const Entry& entry) const;
  void put(const Key& key, Entry& entry, std::shared_ptr<const EncodedTile> tile);

  const std::size_t budget_bytes_;
  mutable std::mutex mutex_;
  // Guarded by mutex_:
  std::map<Key, std::shared_ptr<Entry>> entries_;
  std::list<Key> by_use_;  // least recently used first
  std::size_t bytes_ = 0;
  std::uint64_t encoded_ = 0;
};

}  // namespace tessera::watch
