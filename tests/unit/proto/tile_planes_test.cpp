// SPDX-License-Identifier: Apache-2.0
// Sums in byte planes.
#include "proto/tile_planes.hpp"

#include <gtest/gtest.h>
#include <zstd.h>

namespace tessera::proto {
namespace {

// Later releases must read stored data, so the encoding itself is fixed: a round trip is not enough.
TEST(TilePlanes, HoldTheLowestBytesFirst) {
  constexpr std::size_t kCount = 45;
  std::vector<std::uint64_t> sums(kCount), odd_sums(kCount);
  std::string expected(16 * kCount, '\0');
  for (std::size_t i = 0; i < 2 * kCount; ++i) {
    std::uint64_t& sum = i < kCount ? sums[i] : odd_sums[i - kCount];
    for (std::size_t plane = 0; plane < 8; ++plane) {
      const std::uint64_t byte = (i * 31 + plane * 7 + 1) & 0xff;
      sum |= byte << (8 * plane);
      expected[plane * 2 * kCount + i] = static_cast<char>(byte);
    }
  }
  const std::string frame = encode_planes(sums, odd_sums);
  std::string planes(expected.size(), '\0');
  ASSERT_EQ(ZSTD_decompress(planes.data(), planes.size(), frame.data(), frame.size()), planes.size());
  EXPECT_EQ(planes, expected);
}

TEST(TilePlanes, AreSmallWhereHighBytesAreAlike) {
  std::vector<std::uint64_t> sums(12288), odd_sums(12288);
  std::uint64_t state = 1;
  for (std::uint64_t& sum : sums) {
    state = state * 6364136223846793005 + 1442695040888963407;
    sum = state >> 40;  // three bytes of noise under five of zeros
  }
  EXPECT_LT(encode_planes(sums, odd_sums).size(), 12288 * 3 + 500);
}

}  // namespace
}  // namespace tessera::proto
