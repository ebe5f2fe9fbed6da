// SPDX-License-Identifier: Apache-2.0
// Cuts a local render into calls of render(): every sample of every pixel once, each call as much work as
// asked for. The picture is the same however it is cut; this is about staying responsive. Not thread-safe.
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

// Goes through the grid's window block by block: first all samples of the first block, which is kBlockTiles
// by kBlockTiles tiles, so that one call has work for many threads.
class WorkCutter {
 public:
  WorkCutter(core::TileGrid grid, std::uint32_t spp);

  // The next piece, of about `target_samples` but at least one sample of a tile and at most all samples of a
  // block; nullopt when all is handed out.
  std::optional<WorkPiece> next(std::uint64_t target_samples);

  static constexpr int kBlockTiles = 4;

 private:
  WorkPiece take_block(core::PixelRect block, std::uint64_t target_samples);
  WorkPiece take_tiles(core::PixelRect block, std::uint64_t target_samples);
  void advance(std::uint32_t samples);

  core::TileGrid blocks_;
  int tile_px_;
  std::uint32_t spp_;
  // What comes next: tile `tile_` (within the block) of sample `sample_` of block `block_`.
  int block_ = 0;
  std::uint32_t sample_ = 0;
  int tile_ = 0;
};

}  // namespace tessera::client
