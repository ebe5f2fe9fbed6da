// SPDX-License-Identifier: Apache-2.0
#include "server/store/row_codec.hpp"

#include <fmt/format.h>
#include <xxhash.h>

namespace tessera::store {

namespace {

void put_u32(std::string& out, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) out.push_back(static_cast<char>(value >> shift & 0xff));
}

std::uint32_t get_u32(std::string_view bytes, std::size_t offset) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    value |= static_cast<std::uint32_t>(static_cast<unsigned char>(bytes[offset + i])) << (8 * i);
  }
  return value;
}

}  // namespace

std::string encode_ranges(const std::vector<core::SampleRange>& ranges) {
  std::string bytes;
  for (const core::SampleRange& range : ranges) {
    put_u32(bytes, range.begin);
    put_u32(bytes, range.end);
  }
  return bytes;
}

std::vector<core::SampleRange> decode_ranges(std::string_view bytes) {
  std::vector<core::SampleRange> ranges;
  for (std::size_t at = 0; at + 8 <= bytes.size(); at += 8) {
    ranges.push_back({get_u32(bytes, at), get_u32(bytes, at + 4)});
  }
  return ranges;
}

std::optional<std::uint64_t> bundle_checksum(std::string_view bundle) {
  if (bundle.empty()) return std::nullopt;
  return XXH3_64bits(bundle.data(), bundle.size());
}

std::uint64_t row_checksum(const JobRow& row, std::optional<std::uint64_t> bundle_sum) {
  // Columns that later releases added are included only if they are not 0 or empty, so that older rows keep
  // their checksum.
  std::string key = fmt::format("{} {} {} {} {} {} {}", row.id, row.revision, row.state, row.spp,
                                row.priority, row.created_ms, row.finished_ms.value_or(-1));
  if (row.max_workers != 0) key += fmt::format(" max_workers {}", row.max_workers);
  if (!row.failure_details.empty()) key += fmt::format(" failure_details {}", row.failure_details.size());
  if (!row.submission.empty()) key += fmt::format(" submission {}", row.submission.size());
  if (bundle_sum) key += fmt::format(" bundle {}", *bundle_sum);
  if (!row.owner.empty()) key += fmt::format(" owner {}", row.owner.size());
  if (!row.producers.empty()) key += fmt::format(" producers {}", row.producers.size());
  if (!row.targets.empty()) key += fmt::format(" targets {}", row.targets.size());
  std::uint64_t hash = XXH3_64bits(key.data(), key.size());
  for (const std::string* part : {&row.request_id, &row.spec, &row.failure, &row.counters, &row.arithmetic})
    hash = XXH3_64bits_withSeed(part->data(), part->size(), hash);
  for (const std::string* part :
       {&row.failure_details, &row.submission, &row.owner, &row.producers, &row.targets})
    if (!part->empty()) hash = XXH3_64bits_withSeed(part->data(), part->size(), hash);
  return hash;
}

std::uint64_t row_checksum(const TileRow& row, std::string_view done) {
  const std::string key = fmt::format("{} {} {}", row.job_id, row.tile, done.size());
  std::uint64_t hash = XXH3_64bits(key.data(), key.size());
  for (const std::string_view part : {done, std::string_view(row.content)}) {
    hash = XXH3_64bits_withSeed(part.data(), part.size(), hash);
  }
  return hash;
}

std::uint64_t row_checksum(std::string_view id, std::string_view content) {
  const std::uint64_t hash = XXH3_64bits(id.data(), id.size());
  return XXH3_64bits_withSeed(content.data(), content.size(), hash);
}

}  // namespace tessera::store
