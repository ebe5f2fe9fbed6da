// SPDX-License-Identifier: Apache-2.0
// Divides a local render into calls of render(): every sample of every pixel once, with a given amount of
// work for each call. The image does not depend on the division, which only keeps the program responsive.
// Not thread-safe.
#pragma once

#include <cstdint>
#include <optional>

#include "core/film/region.hpp"

namespace tessera::client {

struct WorkPiece {
  core::PixelRect rect;  // a union of grid tiles
  core::SampleRange range;

  std::uint64_t samples() const { return std::uint64_t{rect.pixel_count()} * range.count(); }
};

// Visits the grid's window block by block: all samples of the first block of kBlockTiles by kBlockTiles
// tiles first, so that one call has work for many threads.
class WorkCutter {
 public:
  WorkCutter(core::TileGrid grid, std::uint32_t spp);

  // The next piece, of about `target_samples`, but at least one sample of a tile and at most all samples of
  // a block; nullopt at the end.
  std::optional<WorkPiece> next(std::uint64_t target_samples);

  static constexpr int kBlockTiles = 4;

 private:
  WorkPiece take_block(core::PixelRect block, std::uint64_t target_samples);
  WorkPiece take_tiles(core::PixelRect block, std::uint64_t target_samples);
  void advance(std::uint32_t samples);

  core::TileGrid blocks_;
  int tile_px_;
  std::uint32_t spp_;
  // The position of the next piece: tile `tile_` (within the block), sample `sample_`, block `block_`.
  int block_ = 0;
  std::uint32_t sample_ = 0;
  int tile_ = 0;
};

}  // namespace tessera::client
