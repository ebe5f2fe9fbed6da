// SPDX-License-Identifier: Apache-2.0
#include "core/view/tile_pixels.hpp"

#include <gtest/gtest.h>
#include <half.h>

#include <algorithm>
#include <vector>

#include "core/view/encoded_tiles.hpp"
#include "tests/unit/view/view_fixture.hpp"

namespace tessera::view {
namespace {

TEST(TilePixels, AreTheHalvesOfOpenExr) {
  core::Image image(3, 1);
  image.pixels = {{0.1f, -2, 1e-7f}, {65504, 1e6f, -1e6f}, {0, 2049, 1e-9f}};
  const auto encoded = encode_pixels(image, PixelFormat::kHalf);
  ASSERT_TRUE(encoded);
  const std::vector<float> expected = {0.1f, -2, 1e-7f, 65504, 65504, -65504, 0, 2048, 0};
  const auto values = halves(*encoded, expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_EQ(values[i], Imath::half(expected[i]).bits()) << i;
}

TEST(TilePixels, OfLevelZeroAreThoseOfTheFilm) {
  GrowingFilm growing;
  growing.add_to_all(0, 3);
  const core::Image image = growing.film.develop();
  const core::PixelRect window = growing.film.grid().window();
  for (int tile = 0; tile < growing.film.grid().tile_count(); ++tile) {
    const core::PixelRect rect = growing.film.grid().rect(tile);
    const core::Image pixels = develop_level(rect, growing.film.tile(tile), 0);
    for (int y = 0; y < rect.height(); ++y)
      for (int x = 0; x < rect.width(); ++x)
        ASSERT_EQ(pixels.at(x, y), image.at(rect.x0 - window.x0 + x, rect.y0 - window.y0 + y));
  }
}

// Also at the right and lower edges, where blocks are cut.
TEST(TilePixels, OfOtherLevelsAreMeans) {
  GrowingFilm growing;
  growing.add_to_all(0, 3);
  for (const int tile : {0, 2, 8}) {
    const core::PixelRect rect = growing.film.grid().rect(tile);
    const auto sums = growing.film.tile(tile);
    const core::Image fine = develop_level(rect, sums, 0);
    for (int level = 1; level <= kMaxLevel; ++level) {
      const core::Image coarse = develop_level(rect, sums, level);
      ASSERT_EQ(coarse.width, level_size(rect.width(), level));
      ASSERT_EQ(coarse.height, level_size(rect.height(), level));
      for (int y = 0; y < coarse.height; ++y) {
        for (int x = 0; x < coarse.width; ++x) {
          double sum = 0;
          int count = 0;
          for (int j = y << level; j < std::min((y + 1) << level, rect.height()); ++j)
            for (int i = x << level; i < std::min((x + 1) << level, rect.width()); ++i, ++count)
              sum += fine.at(i, j).g;
          ASSERT_NEAR(coarse.at(x, y).g, sum / count, 1e-5 * sum / count) << level << ' ' << x << ' ' << y;
        }
      }
    }
  }
}

TEST(TilePixels, WithoutSamplesAreBlack) {
  const core::Image image = develop_level({0, 0, 64, 64}, {}, 3);
  EXPECT_EQ(image.width, 8);
  EXPECT_EQ(image.at(7, 7), core::Rgb());
}

TEST(EncodedTiles, AreMadeOnceAndDroppedByUse) {
  EncodedTiles tiles(30'000);
  GrowingFilm growing;
  growing.add_to_all(0, 1);
  int reads = 0;
  const auto get = [&](int tile, int level = 0, Revision revision = 1) {
    return tiles.get({"job", tile, PixelFormat::kHalf, level}, revision, growing.film.grid().rect(tile), [&] {
      ++reads;
      return core::Result<TileAtRevision>(TileAtRevision{growing.film.tile(tile), revision});
    });
  };
  const std::size_t size = (*get(0))->pixels.size();
  ASSERT_TRUE(size > 15'500 && size < 29'000) << "one fits into the budget, and two do not: " << size;
  EXPECT_TRUE(get(0));
  EXPECT_EQ(reads, 1);
  EXPECT_TRUE(get(0, 6));
  EXPECT_EQ(reads, 2) << "each level is of its own";
  EXPECT_TRUE(get(0, 6, 2));
  EXPECT_EQ(reads, 3) << "it was older";
  EXPECT_TRUE(get(1));
  EXPECT_TRUE(get(1));
  EXPECT_EQ(reads, 4);
  EXPECT_TRUE(get(0));
  EXPECT_EQ(reads, 5) << "it was dropped";
}

}  // namespace
}  // namespace tessera::view
