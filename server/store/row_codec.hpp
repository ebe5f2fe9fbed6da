// SPDX-License-Identifier: Apache-2.0
// Encodes jobs and tiles as rows of the database: lists of ranges as bytes, and checksums. Stateless.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/job_store.hpp"

namespace tessera::store {

// Pairs of little-endian 32-bit numbers.
std::string encode_ranges(const std::vector<core::SampleRange>& ranges);
// Trailing bytes are ignored.
std::vector<core::SampleRange> decode_ranges(std::string_view bytes);

// Covers all columns of a row, to detect any change on disk. `done`: the tile's ranges as stored.
std::uint64_t row_checksum(const JobRow& row);
std::uint64_t row_checksum(const TileRow& row, std::string_view done);

}  // namespace tessera::store
