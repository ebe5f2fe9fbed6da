// SPDX-License-Identifier: Apache-2.0
#include "client/farm/tile_image.hpp"

#include <gtest/gtest.h>
#include <half.h>
#include <libdeflate.h>

#include <cstdint>
#include <string>
#include <vector>

namespace tessera::client {
namespace {

std::string deflated(const std::vector<std::uint16_t>& halves) {
  libdeflate_compressor* const compressor = ::libdeflate_alloc_compressor(1);
  std::string bytes(::libdeflate_zlib_compress_bound(compressor, 2 * halves.size()), '\0');
  bytes.resize(
      ::libdeflate_zlib_compress(compressor, halves.data(), 2 * halves.size(), bytes.data(), bytes.size()));
  ::libdeflate_free_compressor(compressor);
  return bytes;
}

v1::TileImage tile_at(std::uint32_t x0, std::uint32_t y0, std::uint32_t width, std::uint32_t height) {
  v1::TileImage tile;
  tile.mutable_rect()->set_x0(x0);
  tile.mutable_rect()->set_y0(y0);
  tile.mutable_rect()->set_x1(x0 + width);
  tile.mutable_rect()->set_y1(y0 + height);
  std::vector<std::uint16_t> halves;
  for (std::uint32_t i = 0; i < 3 * width * height; ++i)
    halves.push_back(Imath::half(0.5f * static_cast<float>(i)).bits());
  tile.set_pixels_zlib(deflated(halves));
  return tile;
}

TEST(TileImages, ArePaintedWhereTheyLieInTheWindow) {
  core::Image image(4, 3);
  ASSERT_TRUE(paint_tile(tile_at(11, 21, 2, 2), {10, 20, 14, 23}, image));
  EXPECT_EQ(image.at(1, 1), (core::Rgb{0, 0.5f, 1}));
  EXPECT_EQ(image.at(2, 2), (core::Rgb{4.5f, 5, 5.5f}));
  EXPECT_EQ(image.at(0, 0), core::Rgb{});
}

TEST(TileImages, ThatAreDamagedAreRefused) {
  core::Image image(4, 3);
  EXPECT_FALSE(paint_tile(tile_at(11, 21, 4, 2), {10, 20, 14, 23}, image)) << "outside";
  v1::TileImage tile = tile_at(10, 20, 2, 2);
  tile.mutable_rect()->set_y1(23);
  EXPECT_FALSE(paint_tile(tile, {10, 20, 14, 23}, image)) << "too few pixels";
  tile = tile_at(10, 20, 2, 2);
  tile.mutable_pixels_zlib()->back() ^= 1;
  EXPECT_FALSE(paint_tile(tile, {10, 20, 14, 23}, image)) << "a wrong checksum";
}

}  // namespace
}  // namespace tessera::client
