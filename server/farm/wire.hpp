// SPDX-License-Identifier: Apache-2.0
// Conversions between the scheduler's types and the messages of the protocol. Pure functions.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/film/region.hpp"
#include "server/scheduler/scheduler.hpp"
#include "tessera/v1/render_service.pb.h"
#include "tessera/v1/worker_service.pb.h"

namespace tessera::farm {

v1::JobState to_wire(scheduler::JobState state);
// RUNNING for an unknown value.
scheduler::JobState from_wire(v1::JobState state);

// In a few words, for Job.waiting_reason; empty for Waiting::kNo.
std::string_view waiting_reason(scheduler::Waiting waiting);

// The grid is that of the job. The tile must be one of it.
v1::WorkItem to_wire(const scheduler::WorkItem& item, const scheduler::JobGrid& grid);
v1::Failure to_wire(const scheduler::Failure& failure, const scheduler::JobGrid& grid);

v1::Lease to_wire(const scheduler::LeaseDescription& lease, const scheduler::JobGrid& grid);
// Leaves out empty items. Rectangles and images that are no tile of the job become kNoTile.
scheduler::LeaseDescription from_wire(const v1::Lease& lease, const scheduler::JobGrid& grid);
// An empty item becomes one of kNoTile, too.
scheduler::Rendering from_wire(const v1::Rendering& rendering, const scheduler::JobGrid& grid);

// `seen_ms` is when it was last seen, in milliseconds since 1970-01-01 UTC.
v1::Worker to_wire(const scheduler::WorkerView& worker, std::int64_t seen_ms);

// Times outside the years 1 to 9999, which a Timestamp cannot hold, are clamped.
google::protobuf::Timestamp timestamp_from_ms(std::int64_t ms);
std::int64_t ms_from_timestamp(const google::protobuf::Timestamp& timestamp);
google::protobuf::Duration to_wire(scheduler::Duration duration);
double seconds(const google::protobuf::Duration& duration);

}  // namespace tessera::farm
