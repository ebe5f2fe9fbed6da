// SPDX-License-Identifier: Apache-2.0
// How blobs are divided into segments, the unit in which workers get them from the coordinator and from each
// other. Not thread-safe.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "tessera/v1/worker_service.pb.h"

namespace tessera::proto {

// Part of the protocol. So small that one fits into memory and is soon passed on, so large that its bytes
// take longer than the calls for it.
inline constexpr std::uint64_t kSegmentBytes = std::uint64_t{4} << 20;

struct Segment {
  std::uint64_t offset_bytes = 0;
  std::uint64_t size_bytes = 0;
  std::uint64_t index() const { return offset_bytes / kSegmentBytes; }
  bool operator==(const Segment&) const = default;
};

// At least one: an empty blob has one empty segment.
std::uint64_t segment_count(std::uint64_t blob_bytes);
// `index` is below segment_count().
Segment segment_at(std::uint64_t blob_bytes, std::uint64_t index);

v1::BlobSegment to_proto(const Segment& segment);
// INVALID_ARGUMENT unless a blob of this size has such a segment.
core::Result<Segment> from_proto(const v1::BlobSegment& message, std::uint64_t blob_bytes);

// Some of the segments of one blob.
class SegmentSet {
 public:
  // Empty; for `count` segments.
  explicit SegmentSet(std::uint64_t count) : held_(count) {}
  // As SegmentRequest.held has them; missing bytes are zero. INVALID_ARGUMENT: there are more than `count`.
  static core::Result<SegmentSet> from_bytes(const std::string& bytes, std::uint64_t count);
  std::string to_bytes() const;

  std::uint64_t count() const { return held_.size(); }
  bool contains(std::uint64_t index) const { return held_[index]; }
  void insert(std::uint64_t index) { held_[index] = true; }
  bool is_full() const;
  bool is_empty() const;

 private:
  std::vector<bool> held_;
};

}  // namespace tessera::proto
