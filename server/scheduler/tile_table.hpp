// SPDX-License-Identifier: Apache-2.0
// A value for each tile of a job, default-constructed until it is written. Memory is allocated in chunks at
// the first write, so that creating the table of an image of 16K x 16K pixels takes microseconds. Not
// thread-safe.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace tessera::scheduler {

template <typename T>
class TileTable {
 public:
  explicit TileTable(int tiles)
      : tiles_(tiles), chunks_((static_cast<std::size_t>(tiles) + kChunk - 1) / kChunk) {}

  int tile_count() const { return tiles_; }

  // Valid until the tile is written for the first time.
  const T& operator[](int tile) const {
    const auto& chunk = chunks_[static_cast<std::size_t>(tile) / kChunk];
    return chunk == nullptr ? kDefault : (*chunk)[static_cast<std::size_t>(tile) % kChunk];
  }
  T& mutable_at(int tile) {
    auto& chunk = chunks_[static_cast<std::size_t>(tile) / kChunk];
    if (chunk == nullptr) chunk = std::make_unique<Chunk>();
    return (*chunk)[static_cast<std::size_t>(tile) % kChunk];
  }

  // The first tile from this one on that may have been written; tile_count() if there is none.
  int next_written(int tile) const {
    while (tile < tiles_ && chunks_[static_cast<std::size_t>(tile) / kChunk] == nullptr)
      tile = (tile / static_cast<int>(kChunk) + 1) * static_cast<int>(kChunk);
    return tile < tiles_ ? tile : tiles_;
  }

 private:
  static constexpr std::size_t kChunk = 256;
  using Chunk = std::array<T, kChunk>;
  static inline const T kDefault{};

  int tiles_;
  std::vector<std::unique_ptr<Chunk>> chunks_;
};

}  // namespace tessera::scheduler
