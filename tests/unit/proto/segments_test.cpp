// SPDX-License-Identifier: Apache-2.0
#include "proto/segments.hpp"

#include <gtest/gtest.h>

#include "proto/peer_ticket.hpp"

namespace tessera::proto {
namespace {

TEST(Segments, CoverABlob) {
  for (const std::uint64_t size : {std::uint64_t{0}, std::uint64_t{1}, kSegmentBytes - 1, kSegmentBytes,
                                   kSegmentBytes + 1, 5 * kSegmentBytes}) {
    std::uint64_t covered = 0;
    for (std::uint64_t i = 0; i < segment_count(size); ++i) {
      const Segment segment = segment_at(size, i);
      EXPECT_EQ(segment.offset_bytes, covered);
      EXPECT_EQ(segment.index(), i);
      EXPECT_EQ(from_proto(to_proto(segment), size), segment);
      covered += segment.size_bytes;
    }
    EXPECT_EQ(covered, size);
  }
}

TEST(Segments, OfOtherPlacesAndSizesAreRefused) {
  const std::uint64_t size = kSegmentBytes + 10;
  for (const Segment wrong :
       {Segment{1, kSegmentBytes}, Segment{0, kSegmentBytes - 1}, Segment{kSegmentBytes, 11},
        Segment{2 * kSegmentBytes, 0}, Segment{~std::uint64_t{0} - kSegmentBytes, 10}})
    EXPECT_FALSE(from_proto(to_proto(wrong), size)) << wrong.offset_bytes << " " << wrong.size_bytes;
}

TEST(Segments, SetsSurviveTheWire) {
  SegmentSet set(11);
  EXPECT_TRUE(set.is_empty());
  for (const std::uint64_t i : {0, 7, 8, 10}) set.insert(i);
  const auto read = SegmentSet::from_bytes(set.to_bytes(), 11);
  ASSERT_TRUE(read);
  for (std::uint64_t i = 0; i < 11; ++i)
    EXPECT_EQ(read->contains(i), i == 0 || i == 7 || i == 8 || i == 10) << i;
  EXPECT_FALSE(read->is_full());
  EXPECT_TRUE(SegmentSet::from_bytes("\xff", 8)->is_full());
  EXPECT_TRUE(SegmentSet::from_bytes("", 8)->is_empty());
  EXPECT_FALSE(SegmentSet::from_bytes("\xff", 7)) << "more than the blob has";
}

TEST(PeerTickets, AreForOneSegmentOfOneBlobOfOneWorkerAndForAWhile) {
  const std::string key(kTicketKeyBytes, 'k');
  const std::uint64_t size = 3 * kSegmentBytes;
  Digest blob = digest_of("x"), other = digest_of("y");
  blob.size_bytes = other.size_bytes = size;
  const Segment segment = segment_at(size, 1);
  v1::PeerTicket ticket = sign_ticket(key, blob, segment, 100);
  EXPECT_TRUE(is_valid(ticket, key, blob, segment, 100));
  EXPECT_FALSE(is_valid(ticket, key, blob, segment, 101));
  EXPECT_FALSE(is_valid(ticket, key, blob, segment_at(size, 2), 100));
  EXPECT_FALSE(is_valid(ticket, key, other, segment, 100));
  EXPECT_FALSE(is_valid(ticket, std::string(kTicketKeyBytes, 'l'), blob, segment, 100));
  ticket.set_expires_seconds(200);
  EXPECT_FALSE(is_valid(ticket, key, blob, segment, 100)) << "extended by its holder";
  EXPECT_FALSE(is_valid(v1::PeerTicket(), key, blob, segment, 0));
}

}  // namespace
}  // namespace tessera::proto
