// SPDX-License-Identifier: Apache-2.0
#include "client/work_cutter.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <vector>

namespace tessera::client {
namespace {

std::vector<std::uint32_t> no_samples(const core::TileGrid& grid) {
  return std::vector<std::uint32_t>(static_cast<std::size_t>(grid.tile_count()));
}

// Hands out the rest of a render and checks that every sample of every tile comes once, in order, on the
// grid, and that tiles stay even: none has more than twice the samples of another, nor kMaxPassSamples more.
std::vector<WorkPiece> cut(core::TileGrid grid, std::uint32_t spp, std::vector<std::uint32_t> samples,
                           const std::function<std::uint64_t()>& target) {
  std::vector<WorkPiece> pieces;
  WorkCutter cutter(grid, spp, samples);
  const bool is_even = *std::max_element(samples.begin(), samples.end()) == 0;
  while (const auto piece = cutter.next(target())) {
    pieces.push_back(*piece);
    const core::PixelRect& rect = piece->rect;
    EXPECT_FALSE(rect.empty() || piece->range.empty());
    std::size_t pixels = 0;
    for (int tile = 0; tile < grid.tile_count(); ++tile) {
      if (!rect.contains(grid.rect(tile))) continue;
      std::uint32_t& next = samples[static_cast<std::size_t>(tile)];
      EXPECT_EQ(piece->range.begin, next);
      next = piece->range.end;
      pixels += grid.rect(tile).pixel_count();
    }
    EXPECT_EQ(pixels, rect.pixel_count()) << "not a union of tiles";
    const auto [least, most] = std::minmax_element(samples.begin(), samples.end());
    if (is_even) {
      EXPECT_LE(*most, std::max(2 * *least, 1u));
      EXPECT_LE(*most - *least, WorkCutter::kMaxPassSamples);
    }
  }
  for (const std::uint32_t count : samples) EXPECT_EQ(count, spp);
  return pieces;
}

TEST(WorkCutter, CoversEverySampleOnceWhateverTheTargetsAndTheBeginning) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    std::mt19937_64 random(seed);
    const int width = 1 + static_cast<int>(random() % 60), height = 1 + static_cast<int>(random() % 60);
    const auto spp = static_cast<std::uint32_t>(1 + random() % 200);
    const int x = static_cast<int>(random() % 30), y = static_cast<int>(random() % 30);
    const core::TileGrid grid({x, y, x + width, y + height}, 8);
    std::vector<std::uint32_t> samples = no_samples(grid);
    if (seed % 2 == 1)
      for (std::uint32_t& count : samples) count = static_cast<std::uint32_t>(random() % (spp + 1));
    cut(grid, spp, samples, [&random] { return random() >> random() % 64; });
    if (HasFailure()) FAIL() << "seed " << seed << ": " << width << "x" << height << ", " << spp << " spp";
  }
}

TEST(WorkCutter, SmallTargetsGiveSingleTiles) {
  const core::TileGrid grid(32, 16, 8);
  const auto pieces = cut(grid, 2, no_samples(grid), [] { return 1; });
  EXPECT_EQ(pieces.size(), 4u * 2 * 2);
  EXPECT_EQ(pieces[1].rect, (core::PixelRect{8, 0, 16, 8}));
}

TEST(WorkCutter, MediumTargetsGiveRunsOfTiles) {
  const core::TileGrid grid(32, 32, 8);
  const auto pieces = cut(grid, 1, no_samples(grid), [] { return 150; });
  EXPECT_EQ(pieces.size(), 8u);
  EXPECT_EQ(pieces[0].rect, (core::PixelRect{0, 0, 16, 8}));
}

TEST(WorkCutter, LargeTargetsGiveRowsOfTilesInPassesThatDouble) {
  const core::TileGrid grid(64, 32, 8);
  const auto pieces = cut(grid, 100, no_samples(grid), [] { return 1'000'000; });
  std::vector<std::uint32_t> ends;
  for (const WorkPiece& piece : pieces) {
    EXPECT_EQ(piece.rect, grid.window());
    ends.push_back(piece.range.end);
  }
  EXPECT_EQ(ends, (std::vector<std::uint32_t>{1, 2, 4, 8, 16, 32, 64, 100}));
}

TEST(WorkCutter, NoPieceTakesMoreThanItsShareOfMemory) {
  const core::TileGrid grid(65536, 256, 64);
  for (const WorkPiece& piece : cut(grid, 1, no_samples(grid), [] { return ~std::uint64_t{0}; }))
    EXPECT_LE(piece.rect.pixel_count(), WorkCutter::kMaxPiecePixels);
}

}  // namespace
}  // namespace tessera::client
