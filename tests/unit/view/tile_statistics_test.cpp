// SPDX-License-Identifier: Apache-2.0
#include "core/view/tile_statistics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/image/encode.hpp"
#include "core/view/tile_rows.hpp"
#include "tests/unit/view/view_fixture.hpp"

namespace tessera::view {
namespace {

constexpr auto kNever = std::chrono::steady_clock::time_point::max();

TEST(RelativeNoise, ComesFromTheHalves) {
  core::Film::TileSums sums;
  sums.samples = 4;
  sums.odd_samples = 2;
  const std::uint64_t one = std::uint64_t{1} << core::kFilmFractionBits;
  sums.sums.assign(12, 8 * one);      // a mean of 2
  sums.odd_sums.assign(12, 2 * one);  // of 1 for the odd ones, and of 3 for the even ones
  ASSERT_TRUE(relative_noise(sums));
  EXPECT_FLOAT_EQ(*relative_noise(sums), 0.5f);
  sums.sums.assign(12, 0);
  sums.odd_sums.assign(12, 0);
  EXPECT_FALSE(relative_noise(sums)) << "a black tile";
  EXPECT_FALSE(relative_noise({{8 * one}, {0}, 1, 0})) << "one sample";
}

TEST(PixelValue, IsThatOfTheFilm) {
  GrowingFilm growing;
  growing.add_to_all(0, 4);
  const core::Image image = growing.film.develop(), errors = growing.film.standard_error();
  for (const auto& [x, y] : {std::pair{7, 11}, {156, 140}, {80, 100}}) {
    const auto pixel = read_pixel(growing.source, x, y);
    ASSERT_TRUE(pixel);
    EXPECT_EQ(pixel->value, image.at(x - 7, y - 11));
    EXPECT_EQ(pixel->standard_error, errors.at(x - 7, y - 11));
    EXPECT_EQ(pixel->samples, 4u);
  }
  EXPECT_EQ(read_pixel(growing.source, 157, 20).error().code, core::ErrorCode::kOutOfRange);
  EXPECT_EQ(to_json({1, 2, {0.5f, 0, 1}, 3, {0, 0.25f, 0}}),
            R"({"x":1,"y":2,"value":[0.5,0,1],"samples":3,"standard_error":[0,0.25,0]})");
}

TEST(TileStates, AreThoseOfAllTiles) {
  GrowingFilm growing;
  growing.add(4, 0, 6);
  EncodedTiles tiles(1 << 20);
  EXPECT_FALSE(tiles.known_noise("job", 4));
  const auto late = read_tile_states(growing.source, tiles, std::chrono::steady_clock::time_point{});
  ASSERT_TRUE(late);
  EXPECT_FALSE((*late)[4]) << "there was no time";
  const auto states = read_tile_states(growing.source, tiles, kNever);
  ASSERT_TRUE(states);
  ASSERT_EQ(states->size(), 9u);
  EXPECT_EQ((*states)[0]->samples, 0u);
  EXPECT_EQ((*states)[4]->samples, 6u);
  EXPECT_EQ((*states)[4]->noise, relative_noise(growing.film.tile(4)));
  EXPECT_EQ(tiles.known_noise("job", 4), (*states)[4]->noise);
}

TEST(TileRows, AreTheRowsOfTheImage) {
  GrowingFilm growing;
  growing.add_to_all(0, 2);
  const core::Image image = growing.film.develop();
  const core::TileGrid grid = growing.film.grid();
  const core::PixelRect region{30, 20, 150, 139};
  TileRows rows(growing.source, grid, region);
  const core::RowSource source = rows.rows(200, 200);
  ASSERT_EQ(source.width, 120);
  ASSERT_EQ(source.height, 119);
  ASSERT_TRUE(source.position);
  for (const int y : {0, 60, 118, 5}) {
    const auto row = source.row(y);
    ASSERT_TRUE(row);
    for (int x = 0; x < 120; ++x)
      ASSERT_EQ((*row)[x], image.at(region.x0 - 7 + x, region.y0 - 11 + y)) << x << ' ' << y;
  }
}

}  // namespace
}  // namespace tessera::view
