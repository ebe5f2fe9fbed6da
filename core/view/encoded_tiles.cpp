// SPDX-License-Identifier: Apache-2.0
#include "core/view/encoded_tiles.hpp"

#include <utility>

#include "core/view/tile_statistics.hpp"

namespace tessera::view {

namespace {

// What a tile takes besides its pixels.
constexpr std::size_t kBytesPerEntry = 256;

std::size_t bytes_of(const std::shared_ptr<const EncodedTile>& tile) {
  return kBytesPerEntry + (tile ? tile->pixels.size() : 0);
}

core::Result<std::string> encode(const EncodedTiles::Key& key, const core::PixelRect& rect,
                                 const TileAtRevision& tile) {
  if (key.has_all_channels) return encode_channels(tile.layers, rect, tile.sums);
  return encode_pixels(key.layer ? develop_layer(tile.layers, *key.layer, rect, tile.sums, key.level)
                                 : develop_level(rect, tile.sums, key.level),
                       key.format);
}

}  // namespace

std::shared_ptr<EncodedTiles::Entry> EncodedTiles::entry(const Key& key) {
  const core::MutexLock lock(mutex_);
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

std::shared_ptr<const EncodedTile> EncodedTiles::tile_of(const Entry& entry) const {
  const core::MutexLock lock(mutex_);
  return entry.tile;
}

void EncodedTiles::put(const Key& key, Entry& entry, std::shared_ptr<const EncodedTile> tile) {
  const core::MutexLock lock(mutex_);
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

core::Result<std::shared_ptr<const EncodedTile>> EncodedTiles::get(const Key& key, Revision revision,
                                                                   const core::PixelRect& rect,
                                                                   const Read& read) {
  const std::shared_ptr<Entry> wanted = entry(key);
  const auto is_new_enough = [&](const auto& tile) { return tile && tile->revision >= revision; };
  if (auto tile = tile_of(*wanted); is_new_enough(tile)) return tile;
  const core::MutexLock one_encodes(wanted->mutex);
  if (auto tile = tile_of(*wanted); is_new_enough(tile)) return tile;
  const auto samples = read();
  if (!samples) return core::fail(samples.error());
  auto pixels = encode(key, rect, *samples);
  if (!pixels) return core::fail(pixels.error());
  auto tile = std::make_shared<const EncodedTile>(EncodedTile{
      samples->revision, samples->sums.samples, relative_noise(samples->sums), std::move(*pixels)});
  put(key, *wanted, tile);
  return std::shared_ptr<const EncodedTile>(std::move(tile));
}

std::optional<float> EncodedTiles::known_noise(const std::string& job_id, int tile) const {
  const core::MutexLock lock(mutex_);
  std::shared_ptr<const EncodedTile> newest;
  for (auto entry = entries_.lower_bound({job_id, tile, PixelFormat::kHalf, 0}); entry != entries_.end();
       ++entry) {
    if (entry->first.job_id != job_id || entry->first.tile != tile) break;
    const auto& known = entry->second->tile;
    if (known && (!newest || known->revision > newest->revision)) newest = known;
  }
  return newest ? newest->noise : std::nullopt;
}

std::uint64_t EncodedTiles::encoded_tiles() const {
  const core::MutexLock lock(mutex_);
  return encoded_;
}

}  // namespace tessera::view
