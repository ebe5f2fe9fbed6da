// SPDX-License-Identifier: Apache-2.0
#include "client/work_cutter.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <vector>

namespace tessera::client {
namespace {

// Hands out a whole render and checks that every sample of every pixel comes once, in order, on the grid.
std::vector<WorkPiece> cut(core::TileGrid grid, std::uint32_t spp,
                           const std::function<std::uint64_t()>& target) {
  std::vector<std::uint32_t> samples(static_cast<std::size_t>(grid.width() * grid.height()));
  std::vector<WorkPiece> pieces;
  WorkCutter cutter(grid, spp);
  while (const auto piece = cutter.next(target())) {
    pieces.push_back(*piece);
    const core::PixelRect& rect = piece->rect;
    EXPECT_FALSE(rect.empty() || piece->range.empty());
    const core::PixelRect& window = grid.window();
    EXPECT_TRUE((rect.x0 - window.x0) % grid.tile_px() == 0 && (rect.y0 - window.y0) % grid.tile_px() == 0);
    EXPECT_TRUE((rect.x1 - window.x0) % grid.tile_px() == 0 || rect.x1 == window.x1);
    EXPECT_TRUE((rect.y1 - window.y0) % grid.tile_px() == 0 || rect.y1 == window.y1);
    for (int y = rect.y0; y < rect.y1; ++y) {
      for (int x = rect.x0; x < rect.x1; ++x) {
        std::uint32_t& next =
            samples[static_cast<std::size_t>((y - window.y0) * grid.width() + x - window.x0)];
        EXPECT_EQ(piece->range.begin, next);
        next = piece->range.end;
      }
    }
  }
  for (const std::uint32_t count : samples) EXPECT_EQ(count, spp);
  return pieces;
}

TEST(WorkCutter, CoversEverySampleOnceWhateverTheTargets) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    std::mt19937_64 random(seed);
    const int width = 1 + static_cast<int>(random() % 60), height = 1 + static_cast<int>(random() % 60);
    const auto spp = static_cast<std::uint32_t>(1 + random() % 20);
    const int x = static_cast<int>(random() % 30), y = static_cast<int>(random() % 30);
    cut(core::TileGrid({x, y, x + width, y + height}, 8), spp,
        [&random] { return random() >> random() % 64; });
    if (HasFailure()) FAIL() << "seed " << seed << ": " << width << "x" << height << ", " << spp << " spp";
  }
}

TEST(WorkCutter, SmallTargetsGiveSingleTiles) {
  const auto pieces = cut(core::TileGrid(32, 16, 8), 2, [] { return 1; });
  EXPECT_EQ(pieces.size(), 4u * 2 * 2);
  EXPECT_EQ(pieces[1].rect, (core::PixelRect{8, 0, 16, 8}));
}

TEST(WorkCutter, MediumTargetsGiveRunsOfTiles) {
  const auto pieces = cut(core::TileGrid(32, 32, 8), 1, [] { return 150; });
  EXPECT_EQ(pieces.size(), 8u);
  EXPECT_EQ(pieces[0].rect, (core::PixelRect{0, 0, 16, 8}));
}

TEST(WorkCutter, LargeTargetsGiveBlocksWithManySamples) {
  const auto pieces = cut(core::TileGrid(64, 32, 8), 100, [] { return 32 * 32 * 60; });
  ASSERT_EQ(pieces.size(), 4u);
  EXPECT_EQ(pieces[0].rect, (core::PixelRect{0, 0, 32, 32}));
  EXPECT_EQ(pieces[0].range, (core::SampleRange{0, 60}));
  EXPECT_EQ(pieces[1].range, (core::SampleRange{60, 100}));
}

}  // namespace
}  // namespace tessera::client
