// SPDX-License-Identifier: Apache-2.0
#include "client/work_cutter.hpp"

#include <algorithm>

namespace tessera::client {

using core::PixelRect;

WorkCutter::WorkCutter(core::TileGrid grid, std::uint32_t spp)
    : blocks_(grid.window(), grid.tile_px() * kBlockTiles), tile_px_(grid.tile_px()), spp_(spp) {}

std::optional<WorkPiece> WorkCutter::next(std::uint64_t target_samples) {
  if (block_ == blocks_.tile_count()) return std::nullopt;
  const PixelRect block = blocks_.rect(block_);
  const bool whole = tile_ == 0 && target_samples >= block.pixel_count();
  return whole ? take_block(block, target_samples) : take_tiles(block, target_samples);
}

WorkPiece WorkCutter::take_block(PixelRect block, std::uint64_t target_samples) {
  const std::uint64_t wanted = target_samples / block.pixel_count();
  const auto count = static_cast<std::uint32_t>(std::min<std::uint64_t>(wanted, spp_ - sample_));
  const WorkPiece piece{block, {sample_, sample_ + count}};
  advance(count);
  return piece;
}

// One sample of a run of tiles in one row of the block.
WorkPiece WorkCutter::take_tiles(PixelRect block, std::uint64_t target_samples) {
  const core::TileGrid tiles(block, tile_px_);
  PixelRect run = tiles.rect(tile_++);
  while (tile_ % tiles.columns() != 0) {
    const PixelRect next = tiles.rect(tile_);
    if (run.pixel_count() + next.pixel_count() > target_samples) break;
    run.x1 = next.x1;
    ++tile_;
  }
  const WorkPiece piece{run, {sample_, sample_ + 1}};
  if (tile_ == tiles.tile_count()) {
    tile_ = 0;
    advance(1);
  }
  return piece;
}

void WorkCutter::advance(std::uint32_t samples) {
  sample_ += samples;
  if (sample_ < spp_) return;
  sample_ = 0;
  ++block_;
}

}  // namespace tessera::client
