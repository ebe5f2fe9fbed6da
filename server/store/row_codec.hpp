// SPDX-License-Identifier: Apache-2.0
// Encodes jobs and tiles as rows of the database: lists of ranges as bytes, and checksums. Stateless.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/job_store.hpp"

namespace tessera::store {

// Pairs of little-endian 32-bit numbers.
std::string encode_ranges(const std::vector<core::SampleRange>& ranges);
// Trailing bytes are ignored.
std::vector<core::SampleRange> decode_ranges(std::string_view bytes);

// Of a bundle; absent for an empty one.
std::optional<std::uint64_t> bundle_checksum(std::string_view bundle);

// Covers all columns of a row, to detect any change on disk, except JobRow::settled. A bundle is covered
// through its own checksum, so that it need not be read. `done`: the tile's ranges as stored.
std::uint64_t row_checksum(const JobRow& row, std::optional<std::uint64_t> bundle_sum);
std::uint64_t row_checksum(const TileRow& row, std::string_view done);
// Of an entry of the quarantine.
std::uint64_t row_checksum(std::string_view id, std::string_view content);

}  // namespace tessera::store
