// SPDX-License-Identifier: Apache-2.0
#include "proto/segments.hpp"

#include <algorithm>

namespace tessera::proto {

std::uint64_t segment_count(std::uint64_t blob_bytes) {
  return blob_bytes == 0 ? 1 : (blob_bytes - 1) / kSegmentBytes + 1;
}

Segment segment_at(std::uint64_t blob_bytes, std::uint64_t index) {
  const std::uint64_t offset = index * kSegmentBytes;
  return {offset, std::min(kSegmentBytes, blob_bytes - offset)};
}

v1::BlobSegment to_proto(const Segment& segment) {
  v1::BlobSegment message;
  message.set_offset_bytes(segment.offset_bytes);
  message.set_size_bytes(segment.size_bytes);
  return message;
}

core::Result<Segment> from_proto(const v1::BlobSegment& message, std::uint64_t blob_bytes) {
  const Segment segment{message.offset_bytes(), message.size_bytes()};
  if (segment.index() < segment_count(blob_bytes) && segment == segment_at(blob_bytes, segment.index()))
    return segment;
  return core::fail(core::ErrorCode::kInvalidArgument, "segment: the blob has no such segment");
}

core::Result<SegmentSet> SegmentSet::from_bytes(const std::string& bytes, std::uint64_t count) {
  SegmentSet set(count);
  for (std::uint64_t i = 0; i < 8 * bytes.size(); ++i) {
    if ((static_cast<unsigned char>(bytes[i / 8]) >> (i % 8) & 1) == 0) continue;
    if (i >= count)
      return core::fail(core::ErrorCode::kInvalidArgument, "segment.held: the blob has fewer segments");
    set.insert(i);
  }
  return set;
}

std::string SegmentSet::to_bytes() const {
  std::string bytes((held_.size() + 7) / 8, '\0');
  for (std::uint64_t i = 0; i < held_.size(); ++i)
    if (held_[i]) bytes[i / 8] = static_cast<char>(static_cast<unsigned char>(bytes[i / 8]) | 1u << (i % 8));
  return bytes;
}

bool SegmentSet::is_full() const {
  return std::find(held_.begin(), held_.end(), false) == held_.end();
}

bool SegmentSet::is_empty() const {
  return std::find(held_.begin(), held_.end(), true) == held_.end();
}

}  // namespace tessera::proto
