// SPDX-License-Identifier: Apache-2.0
// Divides a local render into calls of render(): every sample of every pixel once, with a given amount of
// work for each call. The image does not depend on the division, which keeps the program responsive and the
// image so far even. Not thread-safe.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/film/region.hpp"

namespace tessera::client {

struct WorkPiece {
  core::PixelRect rect;  // a union of grid tiles
  core::SampleRange range;

  std::uint64_t samples() const { return std::uint64_t{rect.pixel_count()} * range.count(); }
};

// Works in passes over the whole window: each doubles the samples of all tiles, until a pass adds
// kMaxPassSamples to each. Large enough passes keep the cost of a call small beside its samples.
class WorkCutter {
 public:
  // `samples` are those that each tile of the grid has already: its samples from 0 on. None has more than
  // `spp`.
  WorkCutter(core::TileGrid grid, std::uint32_t spp, std::vector<std::uint32_t> samples);

  // The next piece, of about `target_samples`, but at least one sample of a tile; nullopt at the end. Tiles
  // with fewer samples than the pass gives come first.
  std::optional<WorkPiece> next(std::uint64_t target_samples);

  static constexpr std::uint32_t kMaxPassSamples = 64;
  static constexpr std::size_t kMaxPiecePixels = std::size_t{1} << 20;  // bounds the memory of a piece

 private:
  bool find_tile();
  void begin_pass();
  core::PixelRect widen(std::uint64_t pixels) const;
  bool extends(int tile) const;
  bool row_extends(int row) const;

  core::TileGrid grid_;
  std::uint32_t spp_;
  std::vector<std::uint32_t> samples_;  // of each tile
  std::uint32_t pass_end_ = 0;          // the samples that each tile has after this pass
  int tile_ = 0;                        // where the search for the next piece begins
};

}  // namespace tessera::client
