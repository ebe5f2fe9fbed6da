// SPDX-License-Identifier: Apache-2.0
// How jobs and tiles become rows of the database: lists of ranges as bytes, and checksums. Stateless.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/job_store.hpp"

namespace tessera::store {

// Pairs of little-endian 32-bit numbers.
std::string encode_ranges(const std::vector<core::SampleRange>& ranges);
// What is left over at the end is overlooked.
std::vector<core::SampleRange> decode_ranges(std::string_view bytes);

// Over everything in a row, so that what the disk changed is noticed whichever part it is. `done`: the tile's
// ranges as they are stored.
std::uint64_t row_checksum(const JobRow& row);
std::uint64_t row_checksum(const TileRow& row, std::string_view done);

}  // namespace tessera::store
