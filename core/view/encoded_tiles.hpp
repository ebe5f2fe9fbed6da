// SPDX-License-Identifier: Apache-2.0
// Encoded tiles, shared by all who watch an image: each revision of a tile is developed and encoded once in
// each format and at each level, however many watch, as long as the tiles that are watched fit into the
// budget. The least recently used ones are dropped. Thread-safe.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "core/base/error.hpp"
#include "core/base/mutex.hpp"
#include "core/view/shown_layer.hpp"
#include "core/view/tile_pixels.hpp"
#include "core/view/tile_source.hpp"

namespace tessera::view {

struct EncodedTile {
  Revision revision = 0;
  std::uint32_t samples = 0;
  std::optional<float> noise{};  // relative_noise()
  std::string pixels{};          // as the format says
};

class EncodedTiles {
 public:
  explicit EncodedTiles(std::size_t budget_bytes) : budget_bytes_(budget_bytes) {}

  struct Key {
    std::string job_id;
    int tile = 0;
    PixelFormat format = PixelFormat::kHalf;
    int level = 0;
    ShownLayer layer{};
    // encode_channels() instead, at level 0.
    bool has_all_channels = false;
    auto operator<=>(const Key&) const = default;
  };
  using Read = std::function<core::Result<TileAtRevision>()>;
  // The tile at this revision or a later one. If it is not there, reads the samples and encodes them; others
  // who want the same tile meanwhile wait for that. `size`: of the tile in pixels.
  core::Result<std::shared_ptr<const EncodedTile>> get(const Key& key, Revision revision,
                                                       const core::PixelRect& rect, const Read& read);

  // The noise of the newest revision of the tile that is here, in whatever format; nothing if none is.
  std::optional<float> known_noise(const std::string& job_id, int tile) const;

  // How many tiles were encoded since the start.
  std::uint64_t encoded_tiles() const;

 private:
  struct Entry {
    core::Mutex mutex;                          // held while the tile is encoded
    std::shared_ptr<const EncodedTile> tile{};  // guarded by the mutex of EncodedTiles; null at first
    std::list<Key>::iterator used{};            // the same
  };

  std::shared_ptr<Entry> entry(const Key& key);
  std::shared_ptr<const EncodedTile> tile_of(const Entry& entry) const;
  void put(const Key& key, Entry& entry, std::shared_ptr<const EncodedTile> tile);

  const std::size_t budget_bytes_;
  mutable core::Mutex mutex_;
  std::map<Key, std::shared_ptr<Entry>> entries_ TESSERA_GUARDED_BY(mutex_);
  std::list<Key> by_use_ TESSERA_GUARDED_BY(mutex_);  // least recently used first
  std::size_t bytes_ TESSERA_GUARDED_BY(mutex_) = 0;
  std::uint64_t encoded_ TESSERA_GUARDED_BY(mutex_) = 0;
};

}  // namespace tessera::view
