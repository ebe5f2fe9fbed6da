// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

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

TEST(JobShape, OfSeveralTargetsOfATileHasTheHighest) {
  EXPECT_EQ(TileTargets({{2, 1}, {1, 6}, {2, 3}, {2, 2}}), TileTargets({{1, 6}, {2, 3}}));
  JobShape shape(80, 64, 4, 2);
  shape.raise(0, {{1, 7}, {1, 9}, {1, 8}});
  EXPECT_EQ(shape.targets, TileTargets({{1, 9}}));
}

// Against a target for each tile. What is added is counted without adding up all of them.
TEST(JobShape, AgreesWithATableOfTargetsThroughRandomRaises) {
  std::mt19937 rng(7);
  for (int round = 0; round < 200; ++round) {
    JobShape shape(640, 64, 1 + static_cast<std::uint32_t>(rng() % 8), 3);
    std::vector<std::uint32_t> table(30, shape.spp);
    for (int step = 0; step < 20; ++step) {
      std::vector<TileTarget> tiles;
      for (std::uint32_t i = rng() % 4; i > 0; --i)
        tiles.push_back({static_cast<int>(rng() % 30), static_cast<std::uint32_t>(rng() % 60)});
      const std::uint32_t all = rng() % 4 == 0 ? static_cast<std::uint32_t>(rng() % 40) : 0;
      const std::uint64_t before = shape.pixel_samples();
      for (std::uint32_t& target : table) target = std::max(target, all);
      for (const TileTarget& each : tiles) {
        std::uint32_t& target = table[static_cast<std::size_t>(each.tile)];
        target = std::max(target, each.spp);
      }
      ASSERT_EQ(shape.is_raised_by(all, tiles), [&] {
        for (int tile = 0; tile < 30; ++tile)
          if (table[static_cast<std::size_t>(tile)] > shape.target(tile)) return true;
        return all > shape.spp;
      }());
      const std::uint64_t added = shape.raise(all, tiles);
      ASSERT_EQ(before + added, shape.pixel_samples());
      std::uint64_t samples = 0;
      for (int tile = 0; tile < 30; ++tile) {
        ASSERT_EQ(shape.target(tile), table[static_cast<std::size_t>(tile)]) << "tile " << tile;
        samples += 64 * 64 * table[static_cast<std::size_t>(tile)];
      }
      ASSERT_EQ(shape.pixel_samples(), samples);
    }
  }
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
    EXPECT_FALSE(check_shape(shape)) << targets.front().tile;
  }
}

}  // namespace
}  // namespace tessera::scheduler
