// SPDX-License-Identifier: Apache-2.0
// Sums of a tile as they travel and are stored: the lowest bytes of all of them, then the second bytes, and
// so on, as a zstd frame. The high bytes of neighbours are alike and the low ones are noise; kept apart, they
// are compressed several times as fast, into fewer bytes, as when they alternate. Pure functions.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::proto {

struct TilePlanes {
  // Both of the same size.
  std::vector<std::uint64_t> sums, odd_sums;
};

std::string encode_planes(const std::vector<std::uint64_t>& sums, const std::vector<std::uint64_t>& odd_sums);
// `count` is the size of each of the two. DATA_LOSS if the frame is damaged or of another size.
core::Result<TilePlanes> decode_planes(std::string_view frame, std::size_t count);

}  // namespace tessera::proto
