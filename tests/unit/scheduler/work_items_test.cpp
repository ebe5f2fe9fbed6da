// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "server/scheduler/types.hpp"

namespace tessera::scheduler {
namespace {

TEST(JobGrid, FindsEveryTileOfAGridByItsRectangle) {
  const JobGrid grid(core::TileGrid(200, 130, core::kTilePx));
  for (int tile = 0; tile < grid.tile_count(); ++tile) EXPECT_EQ(grid.find(0, grid.rect(tile)), tile);
}

TEST(JobGrid, FindsTheTilesOfAWindowAndNoOthers) {
  const JobGrid grid(core::TileGrid({70, 10, 270, 140}, core::kTilePx));
  for (int tile = 0; tile < grid.tile_count(); ++tile) EXPECT_EQ(grid.find(0, grid.rect(tile)), tile);
  for (const core::PixelRect& rect : {core::PixelRect{64, 0, 128, 64},
                                      {0, 0, 64, 64},
                                      {6, 10, 70, 74},
                                      {71, 10, 134, 74},
                                      {262, 10, 326, 74},
                                      {70, 138, 134, 202}}) {
    EXPECT_EQ(grid.find(0, rect), kNoTile) << rect.x0 << ' ' << rect.y0;
  }
}

TEST(JobGrid, KnowsNoTileForAnyOtherRectangle) {
  const JobGrid grid(core::TileGrid(200, 130, core::kTilePx));
  for (const core::PixelRect& rect : {core::PixelRect{0, 0, 0, 0},
                                      {0, 0, 63, 64},
                                      {1, 0, 64, 64},
                                      {0, 0, 128, 64},
                                      {192, 0, 256, 64},
                                      {200, 0, 264, 64},
                                      {-64, 0, 0, 64},
                                      {0, 192, 64, 256}}) {
    EXPECT_EQ(grid.find(0, rect), kNoTile) << rect.x0 << ' ' << rect.y0 << ' ' << rect.x1 << ' ' << rect.y1;
  }
}

TEST(JobGrid, NumbersTheTilesOfAllImagesInOneSequence) {
  const JobGrid grid(core::TileGrid(130, 64, core::kTilePx), 3);
  EXPECT_EQ(grid.tile_count(), 9);
  for (int tile = 0; tile < grid.tile_count(); ++tile) {
    EXPECT_EQ(grid.image_of(tile), tile / 3);
    EXPECT_EQ(grid.rect(tile), grid.rect(tile % 3));
    EXPECT_EQ(grid.find(static_cast<std::uint32_t>(tile / 3), grid.rect(tile)), tile);
  }
  EXPECT_EQ(grid.find(3, grid.rect(0)), kNoTile);
  EXPECT_EQ(grid.find(~0U, grid.rect(0)), kNoTile);
}

TEST(JobShape, CountsTheSamplesOfTilesWithTargetsOfTheirOwn) {
  JobShape shape(80, 64, 4, 2);  // of 64 and 16 columns
  shape.targets = TileTargets({{1, 6}, {2, 1}});
  EXPECT_EQ(shape.target(0), 4u);
  EXPECT_EQ(shape.target(1), 6u);
  EXPECT_EQ(shape.pixel_samples_of(0), 64u * (64 * 4 + 16 * 6));
  EXPECT_EQ(shape.pixel_samples_of(1), 64u * (64 * 1 + 16 * 4));
  EXPECT_EQ(shape.pixel_samples(), shape.pixel_samples_of(0) + shape.pixel_samples_of(1));
}

TEST(JobShape, RaisesTargetsAndLowersNone) {
  JobShape shape(80, 64, 4, 2);
  shape.targets = TileTargets({{1, 6}, {2, 1}});
  EXPECT_FALSE(shape.is_raised_by(0, {{0, 4}, {1, 5}}));
  EXPECT_TRUE(shape.is_raised_by(4, {}));
  shape.raise(0, {{0, 2}, {3, 8}});
  EXPECT_EQ(shape.targets.all(), (TileTargets::ByTile{{1, 6}, {2, 1}, {3, 8}}));
  shape.raise(4);
  EXPECT_EQ(shape.targets.all(), (TileTargets::ByTile{{1, 6}, {3, 8}}));
  shape.raise(8);
  EXPECT_EQ(shape, JobShape(80, 64, 8, 2));
}

TEST(JobShape, IsImpossibleWithoutWorkOrWithTargetsOfTilesThatItDoesNotHave) {
  EXPECT_TRUE(check_shape(JobShape(80, 64, 4, 2)));
  for (const JobShape& shape :
       {JobShape(0, 1, 1), JobShape(1, 1, 0), JobShape(1, 1, 1, 0), JobShape(32768, 32768, 1, 1025)})
    EXPECT_FALSE(check_shape(shape)) << shape.images;
  for (const TileTargets::ByTile& targets :
       {TileTargets::ByTile{{4, 1}}, TileTargets::ByTile{{-1, 1}}, TileTargets::ByTile{{0, 0}}}) {
    JobShape shape(80, 64, 4, 2);
    shape.targets = TileTargets(targets);
    EXPECT_FALSE(check_shape(shape)) << targets.begin()->first;
  }
}

}  // namespace
}  // namespace tessera::scheduler
