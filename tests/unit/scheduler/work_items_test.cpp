// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "server/scheduler/types.hpp"

namespace tessera::scheduler {
namespace {

TEST(TileIndex, FindsEveryTileOfAGridByItsRectangle) {
  const core::TileGrid grid(200, 130, core::kTilePx);
  for (int tile = 0; tile < grid.tile_count(); ++tile) EXPECT_EQ(tile_index(grid, grid.rect(tile)), tile);
}

TEST(TileIndex, FindsTheTilesOfAWindowAndNoOthers) {
  const core::TileGrid grid({70, 10, 270, 140}, core::kTilePx);
  for (int tile = 0; tile < grid.tile_count(); ++tile) EXPECT_EQ(tile_index(grid, grid.rect(tile)), tile);
  for (const core::PixelRect& rect : {core::PixelRect{64, 0, 128, 64},
                                      {0, 0, 64, 64},
                                      {6, 10, 70, 74},
                                      {71, 10, 134, 74},
                                      {262, 10, 326, 74},
                                      {70, 138, 134, 202}}) {
    EXPECT_EQ(tile_index(grid, rect), kNoTile) << rect.x0 << ' ' << rect.y0;
  }
}

TEST(TileIndex, KnowsNoTileForAnyOtherRectangle) {
  const core::TileGrid grid(200, 130, core::kTilePx);
  for (const core::PixelRect& rect : {core::PixelRect{0, 0, 0, 0},
                                      {0, 0, 63, 64},
                                      {1, 0, 64, 64},
                                      {0, 0, 128, 64},
                                      {192, 0, 256, 64},
                                      {200, 0, 264, 64},
                                      {-64, 0, 0, 64},
                                      {0, 192, 64, 256}}) {
    EXPECT_EQ(tile_index(grid, rect), kNoTile)
        << rect.x0 << ' ' << rect.y0 << ' ' << rect.x1 << ' ' << rect.y1;
  }
}

}  // namespace
}  // namespace tessera::scheduler
