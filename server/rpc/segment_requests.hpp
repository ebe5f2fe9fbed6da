// SPDX-License-Identifier: Apache-2.0
// Requests for segments of blobs, and answers that name another worker, on the wire. Pure functions.
#pragma once

#include <string>

#include "core/base/error.hpp"
#include "proto/blob.hpp"
#include "server/blobs/segment_tracker.hpp"
#include "tessera/v1/worker_service.pb.h"

namespace tessera::rpc {

// Of a caller at `peer`, as gRPC names it. The blob must be in the store. INVALID_ARGUMENT: the request is
// malformed, or no segment is missing.
core::Result<blobs::SegmentTracker::Ask> read_segment_request(const v1::SegmentRequest& request,
                                                              const proto::Digest& blob,
                                                              const std::string& peer,
                                                              blobs::SegmentTracker::Time now);

// With a ticket that begins now.
v1::PeerReferral referral_to(const blobs::SegmentTracker::Peer& peer, const proto::Digest& blob,
                             blobs::SegmentTracker::Time now);

}  // namespace tessera::rpc
