// SPDX-License-Identifier: Apache-2.0
// The byte planes in which sums of a tile are sent and stored: the lowest bytes of all sums, then the second
// bytes, and so on, as a zstd frame. The high bytes of neighbours are similar and the low ones are noise. In
// separate planes they compress several times as fast, and into fewer bytes, as in whole sums. Pure
// functions.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::proto {

struct TilePlanes {
  // Both have the same size.
  std::vector<std::uint64_t> sums, odd_sums;
};

std::string encode_planes(const std::vector<std::uint64_t>& sums, const std::vector<std::uint64_t>& odd_sums);
// `count` is the size of each of the two. DATA_LOSS if the frame is damaged or has another size.
core::Result<TilePlanes> decode_planes(std::string_view frame, std::size_t count);

}  // namespace tessera::proto
