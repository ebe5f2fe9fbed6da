// SPDX-License-Identifier: Apache-2.0
#include "server/watch/tile_images.hpp"

#include <utility>

#include "server/watch/tile_pixels.hpp"

namespace tessera::watch {

namespace {

// What a tile takes besides its pixels.
constexpr std::size_t kBytesPerEntry = 256;

std::size_t bytes_of(const std::shared_ptr<const EncodedTile>& tile) {
  return kBytesPerEntry + (tile ? tile->pixels_zlib.size() : 0);
}

// The same as a tile of the whole image: each pixel depends on its own sums alone.
core::Image develop(const core::PixelRect& rect, const core::Film::TileSums& sums) {
  core::Film film(core::TileGrid(rect, std::max(rect.width(), rect.height())));
  film.restore(0, sums);
  return film.develop();
}

}  // namespace

std::shared_ptr<TileImages::Entry> TileImages::entry(const Key& key) {
  const std::lock_guard lock(mutex_);
  std::shared_ptr<Entry>& entry = entries_[key];
  if (!entry) {
    entry = std::make_shared<Entry>();
    entry->used = by_use_.insert(by_use_.end(), key);
    bytes_ += bytes_of(nullptr);
  } else {
    by_use_.splice(by_use_.end(), by_use_, entry->used);
  }
  return entry;
}

std::shared_ptr<const EncodedTile> TileImages::tile_of(const Entry& entry) const {
  const std::lock_guard lock(mutex_);
  return entry.tile;
}

void TileImages::put(const Key& key, Entry& entry, std::shared_ptr<const EncodedTile> tile) {
  const std::lock_guard lock(mutex_);
  ++encoded_;
  const auto found = entries_.find(key);
  if (found == entries_.end() || found->second.get() != &entry) return;  // dropped meanwhile
  bytes_ = bytes_ - bytes_of(entry.tile) + bytes_of(tile);
  entry.tile = std::move(tile);
  while (bytes_ > budget_bytes_ && !by_use_.empty()) {
    const auto oldest = entries_.find(by_use_.front());
    bytes_ -= bytes_of(oldest->second->tile);
    entries_.erase(oldest);
    by_use_.pop_front();
  }
}

core::Result<std::shared_ptr<const EncodedTile>> TileImages::get(const Key& key, events::Revision revision,
                                                                 const core::PixelRect& rect,
                                                                 const Read& read) {
  const std::shared_ptr<Entry> wanted = entry(key);
  const auto is_new_enough = [&](const auto& tile) { return tile && tile->revision >= revision; };
  if (auto tile = tile_of(*wanted); is_new_enough(tile)) return tile;
  const std::lock_guard one_encodes(wanted->mutex);
  if (auto tile = tile_of(*wanted); is_new_enough(tile)) return tile;
  const auto samples = read();
  if (!samples) return core::fail(samples.error());
  auto pixels = encode_pixels(develop(rect, samples->sums), key.format);
  if (!pixels) return core::fail(pixels.error());
  auto tile = std::make_shared<const EncodedTile>(
      EncodedTile{samples->revision, samples->sums.samples, std::move(*pixels)});
  put(key, *wanted, tile);
  return std::shared_ptr<const EncodedTile>(std::move(tile));
}

std::uint64_t TileImages::encoded_tiles() const {
  const std::lock_guard lock(mutex_);
  return encoded_;
}

}  // namespace tessera::watch
