// SPDX-License-Identifier: Apache-2.0
// Leases as messages: what a worker says of those it holds, and what it takes from an answer, within bounds.
// Pure functions.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "tessera/v1/worker_service.pb.h"
#include "worker/held_lease.hpp"
#include "worker/job.hpp"

namespace tessera::worker {

// A bound on the leases of an answer, and of a worker: several times what any coordinator gives.
inline constexpr int kMaxLeases = 64;

// Samples to render.
struct Piece {
  std::uint64_t lease_id = 0;
  std::shared_ptr<const Job> job;
  WorkItem item;
};

v1::Lease to_proto(const HeldLease& lease);
v1::Rendering to_proto(const Piece& piece);

// Not negative, and within the bound on any coordinator's lease time.
Duration heartbeat_timeout(const v1::SynchronizeResponse& response);

// At most kMaxLeases; the rest is ignored.
std::span<const v1::Lease* const> first_leases(const google::protobuf::RepeatedPtrField<v1::Lease>& leases);

// The items that the job has and that are no more than a tile each, since a result cannot hold more. Logs
// that others are left out; the coordinator keeps them.
std::vector<WorkItem> readable_items(const v1::Lease& lease, const v1::JobSpec& job);

}  // namespace tessera::worker
