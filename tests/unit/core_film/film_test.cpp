// SPDX-License-Identifier: Apache-2.0
#include "core/film/film.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace tessera::core {
namespace {

// A sample's value as a function of its number and place, now and then large enough to saturate a sum.
std::uint64_t sample_value(int x, int y, int channel, std::uint32_t s) {
  const std::uint64_t h = (static_cast<std::uint64_t>(x) * 73856093u) ^
                          (static_cast<std::uint64_t>(y) * 19349663u) ^ (s * 83492791ull) ^
                          (static_cast<std::uint64_t>(channel) << 40);
  return h % 1000 == 0 ? kFilmSaturated / 2 : h << 12;
}

FilmTile make_tile(PixelRect rect, SampleRange range) {
  FilmTile tile(rect, range);
  std::size_t i = 0;
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x)
      for (int c = 0; c < 3; ++c, ++i)
        for (std::uint32_t s = range.begin; s < range.end; ++s) {
          tile.sums[i] = add_saturating(tile.sums[i], sample_value(x, y, c, s));
          if (s % 2) tile.odd_sums[i] = add_saturating(tile.odd_sums[i], sample_value(x, y, c, s));
        }
  return tile;
}

TEST(Film, DoesNotDependOnHowSamplesWereCutAndOrdered) {
  constexpr std::uint32_t kSpp = 37;
  const TileGrid grid(50, 33, 16);
  Film whole(grid);
  whole.add(make_tile({0, 0, 50, 33}, {0, kSpp}));

  std::mt19937 random(7);
  for (int round = 0; round < 20; ++round) {
    std::vector<FilmTile> pieces;
    for (int t = 0; t < grid.tile_count(); ++t)
      for (std::uint32_t begin = 0; begin < kSpp;) {
        const std::uint32_t end =
            std::min<std::uint32_t>(kSpp, begin + 1 + static_cast<std::uint32_t>(random() % 9));
        pieces.push_back(make_tile(grid.rect(t), {begin, end}));
        begin = end;
      }
    std::shuffle(pieces.begin(), pieces.end(), random);
    Film film(grid);
    for (const FilmTile& piece : pieces) film.add(piece);
    ASSERT_TRUE(film == whole);
  }
}

TEST(Film, AppendedTilesEqualOneTile) {
  FilmTile tile = make_tile({16, 0, 32, 16}, {3, 8});
  tile.append(make_tile({16, 0, 32, 16}, {8, 21}));
  const FilmTile whole = make_tile({16, 0, 32, 16}, {3, 21});
  EXPECT_EQ(tile.sums, whole.sums);
  EXPECT_EQ(tile.odd_sums, whole.odd_sums);
  EXPECT_EQ(tile.range, whole.range);
}

TEST(Film, DevelopsToTheMeanOfTheSamplesEachPixelHas) {
  Film film(TileGrid(4, 2, 2));
  FilmTile left({0, 0, 2, 2}, {0, 4});
  left.sums.assign(12, to_fixed_point(10, 0));
  film.add(left);
  const Image image = film.develop();
  EXPECT_EQ(image.at(1, 1), Rgb::gray(2.5f));
  EXPECT_EQ(image.at(2, 0), Rgb::gray(0)) << "no samples yet";
}

TEST(Film, EstimatesTheErrorFromTheHalves) {
  Film film(TileGrid(1, 1, 64));
  FilmTile tile({0, 0, 1, 1}, {0, 4});
  tile.sums = {to_fixed_point(8, 0), 0, 0};      // evens 2 + 2, odds 1 + 3
  tile.odd_sums = {to_fixed_point(6, 0), 0, 0};  // now evens mean 1, odds mean 3
  film.add(tile);
  EXPECT_EQ(film.standard_error().at(0, 0), (Rgb{1, 0, 0}));
}

TEST(Film, TellsHowManyPixelsAreFull) {
  Film film(TileGrid(3, 1, 64));
  FilmTile tile({0, 0, 3, 1}, {0, 2});
  tile.sums[4] = kFilmSaturated - 1;
  film.add(tile);
  EXPECT_EQ(film.saturated_pixels(), 0u);
  film.add(tile);
  EXPECT_EQ(film.saturated_pixels(), 1u);
}

TEST(Film, RestoresWhatItHanded) {
  Film film(TileGrid(20, 20, 16));
  film.add(make_tile({0, 0, 20, 20}, {2, 5}));
  Film copy(film.grid());
  for (int t = 0; t < film.grid().tile_count(); ++t) copy.restore(t, film.tile(t));
  EXPECT_TRUE(copy == film);
}

TEST(Film, HasNoSumsOfTilesWithoutSamples) {
  Film film(TileGrid(16384, 16384, 64)), other(film.grid());
  film.add(make_tile(film.grid().rect(70), {0, 1}));
  EXPECT_EQ(film.tile(70).sums.size(), 64u * 64 * 3);
  for (const int tile : {0, 69, 71, 65535}) EXPECT_EQ(film.tile(tile).sums.size(), 0u) << tile;
  EXPECT_FALSE(film == other);
  other.add(make_tile(film.grid().rect(70), {0, 1}));
  EXPECT_TRUE(film == other);
}

TEST(Film, TakesSumsOfAnySize) {
  Film film(TileGrid(64, 64, 64));
  FilmTile tile({0, 0, 64, 64}, {0, 1});
  tile.sums.assign(tile.sums.size(), to_fixed_point(63.9, 0));
  film.add(tile);
  tile.range = {1, 2};
  tile.odd_sums.assign(tile.sums.size(), 1);
  tile.sums = tile.odd_sums;
  film.add(tile);
  tile.range = {2, 4};
  tile.sums.back() = tile.odd_sums.back() = to_fixed_point(64, 0);
  film.add(tile);
  EXPECT_EQ(film.tile(0).sums.front(), to_fixed_point(63.9, 0) + 2);
  EXPECT_EQ(film.tile(0).sums.back(), to_fixed_point(127.9, 0) + 1);
  film.restore(0, {});
  EXPECT_EQ(film.tile(0).sums.size(), 0u);
}

TEST(Film, IsBlackWithoutErrorWhereItHasNoSamples) {
  Film film(TileGrid(32, 16, 16));
  film.add(make_tile({16, 0, 32, 16}, {0, 2}));
  EXPECT_EQ(film.develop().at(3, 5), Rgb{});
  EXPECT_EQ(film.standard_error().at(3, 5), Rgb{});
  EXPECT_NE(film.develop().at(20, 5), Rgb{});
  // A tile whose buffers are there and hold nothing is the same.
  Film::TileSums nothing{std::vector<std::uint64_t>(16 * 16 * 3), std::vector<std::uint64_t>(16 * 16 * 3), 0,
                         0};
  Film copy = film;
  copy.restore(0, nothing);
  EXPECT_TRUE(copy == film);
}

TEST(Film, OfAWindowDevelopsToThosePixelsOfTheWholeImage) {
  const PixelRect window{13, 5, 47, 30};
  Film whole(TileGrid(50, 33, 16)), part(TileGrid(window, 16));
  whole.add(make_tile({0, 0, 50, 33}, {0, 5}));
  for (int t = 0; t < part.grid().tile_count(); ++t) part.add(make_tile(part.grid().rect(t), {0, 5}));
  const Image all = whole.develop(), cropped = part.develop();
  ASSERT_EQ(cropped.width, window.width());
  ASSERT_EQ(cropped.height, window.height());
  for (int y = 0; y < cropped.height; ++y)
    for (int x = 0; x < cropped.width; ++x)
      ASSERT_EQ(cropped.at(x, y), all.at(window.x0 + x, window.y0 + y)) << x << ' ' << y;
  EXPECT_EQ(part.standard_error().at(3, 4), whole.standard_error().at(16, 9));
}

TEST(RenderCounters, KeepTheFirstNonFiniteSampleWhateverTheOrder) {
  RenderCounters a, b;
  a.first_non_finite = SampleId{5, 1, 0};
  b.first_non_finite = SampleId{2, 1, 9};
  a.samples = 3;
  b.samples = 4;
  RenderCounters ab = a, ba = b;
  ab.add(b);
  ba.add(a);
  EXPECT_EQ(ab, ba);
  EXPECT_EQ(ab.samples, 7u);
  EXPECT_EQ(ab.first_non_finite->x, 2);
}

TEST(SampleRange, CountsOddNumbers) {
  EXPECT_EQ((SampleRange{0, 1}).odd_count(), 0u);
  EXPECT_EQ((SampleRange{1, 2}).odd_count(), 1u);
  EXPECT_EQ((SampleRange{3, 8}).odd_count(), 3u);
}

TEST(TileGrid, CoversTheImageOnce) {
  const TileGrid grid(130, 65, 64);
  EXPECT_EQ(grid.tile_count(), 6);
  std::size_t pixels = 0;
  for (int t = 0; t < grid.tile_count(); ++t) pixels += grid.rect(t).pixel_count();
  EXPECT_EQ(pixels, 130u * 65u);
  EXPECT_EQ(grid.rect(5), (PixelRect{128, 64, 130, 65}));
}

TEST(TileGrid, BeginsAtTheTopLeftOfItsWindowAndFindsEveryPixelsTile) {
  const PixelRect window{100, 30, 229, 95};
  const TileGrid grid(window, 64);
  EXPECT_EQ(grid.tile_count(), 6);
  EXPECT_EQ(grid.rect(0), (PixelRect{100, 30, 164, 94}));
  EXPECT_EQ(grid.rect(5), (PixelRect{228, 94, 229, 95}));
  for (int y = window.y0; y < window.y1; ++y)
    for (int x = window.x0; x < window.x1; ++x)
      ASSERT_TRUE(grid.rect(grid.tile_at(x, y)).contains({x, y, x + 1, y + 1})) << x << ' ' << y;
}

TEST(PixelRect, ContainsWhatLiesWithinItToTheLastPixel) {
  const PixelRect rect{10, 20, 30, 40};
  EXPECT_TRUE(rect.contains(rect));
  for (const PixelRect& outside :
       {PixelRect{9, 20, 30, 40}, {10, 19, 30, 40}, {10, 20, 31, 40}, {10, 20, 30, 41}})
    EXPECT_FALSE(rect.contains(outside));
}

}  // namespace
}  // namespace tessera::core
