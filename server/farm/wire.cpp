// SPDX-License-Identifier: Apache-2.0
#include "server/farm/wire.hpp"

#include <google/protobuf/util/time_util.h>

#include <algorithm>

#include "proto/convert.hpp"

namespace tessera::farm {

using google::protobuf::util::TimeUtil;
using scheduler::FailureReason;
using scheduler::JobState;

// Both enumerations have the same numbers.
static_assert(static_cast<int>(FailureReason::kInvalidScene) == v1::Failure::REASON_INVALID_SCENE);
static_assert(static_cast<int>(FailureReason::kLimit) == v1::Failure::REASON_LIMIT);
static_assert(static_cast<int>(FailureReason::kWorkersLost) == v1::Failure::REASON_WORKERS_LOST);
static_assert(static_cast<int>(FailureReason::kDeclined) == v1::Failure::REASON_DECLINED);
static_assert(static_cast<int>(FailureReason::kFileLost) == v1::Failure::REASON_FILE_LOST);
static_assert(static_cast<int>(FailureReason::kFilmLost) == v1::Failure::REASON_FILM_LOST);
static_assert(static_cast<int>(FailureReason::kInternal) == v1::Failure::REASON_INTERNAL);

v1::JobState to_wire(JobState state) {
  switch (state) {
    case JobState::kRunning:
      return v1::JOB_STATE_RUNNING;
    case JobState::kPaused:
      return v1::JOB_STATE_PAUSED;
    case JobState::kDone:
      return v1::JOB_STATE_DONE;
    case JobState::kCancelled:
      return v1::JOB_STATE_CANCELLED;
    case JobState::kFailed:
      return v1::JOB_STATE_FAILED;
  }
  return v1::JOB_STATE_UNSPECIFIED;
}

JobState from_wire(v1::JobState state) {
  switch (state) {
    case v1::JOB_STATE_PAUSED:
      return JobState::kPaused;
    case v1::JOB_STATE_DONE:
      return JobState::kDone;
    case v1::JOB_STATE_CANCELLED:
      return JobState::kCancelled;
    case v1::JOB_STATE_FAILED:
      return JobState::kFailed;
    default:
      return JobState::kRunning;
  }
}

std::string_view waiting_reason(scheduler::Waiting waiting) {
  switch (waiting) {
    case scheduler::Waiting::kNo:
      return "";
    case scheduler::Waiting::kPaused:
      return "paused";
    case scheduler::Waiting::kNoWorker:
      return "no worker is connected";
    case scheduler::Waiting::kDraining:
      return "all connected workers are drained or stopping";
    case scheduler::Waiting::kNoImages:
      return "no connected worker renders jobs of several images: update the workers";
    case scheduler::Waiting::kNoLayers:
      return "no connected worker renders layers: update the workers";
    case scheduler::Waiting::kHigherPriority:
      return "jobs of higher priority are served first";
    case scheduler::Waiting::kTurn:
      return "waits for a free worker";
    case scheduler::Waiting::kVerification:
      return "waits for another worker to verify samples";
    case scheduler::Waiting::kMaxWorkers:
      return "max_workers reached";
  }
  return "";
}

v1::WorkItem to_wire(const scheduler::WorkItem& item, const scheduler::JobGrid& grid) {
  const auto image = static_cast<std::uint32_t>(grid.image_of(item.tile));
  return proto::to_proto(proto::WorkItem{grid.rect(item.tile), item.samples, image});
}

v1::Failure to_wire(const scheduler::Failure& failure, const scheduler::JobGrid& grid) {
  v1::Failure message;
  message.set_reason(static_cast<v1::Failure::Reason>(failure.details.reason));
  message.set_message(failure.message);
  const auto& item = failure.details.item;
  if (item && item->tile >= 0 && item->tile < grid.tile_count())
    *message.mutable_item() = to_wire(*item, grid);
  for (const std::string& worker : failure.details.workers) message.add_workers(worker);
  return message;
}

v1::Lease to_wire(const scheduler::LeaseDescription& lease, const scheduler::JobGrid& grid) {
  v1::Lease message;
  message.set_id(lease.id.value);
  message.set_job_id(lease.job.value);
  message.set_token(lease.token);
  for (const scheduler::WorkItem& item : lease.items) *message.add_items() = to_wire(item, grid);
  return message;
}

scheduler::LeaseDescription from_wire(const v1::Lease& message, const scheduler::JobGrid& grid) {
  scheduler::LeaseDescription lease{{message.id()}, {message.job_id()}, {}, message.token()};
  for (const v1::WorkItem& each : message.items()) {
    const auto item = proto::from_proto(each);
    if (item) lease.items.push_back({grid.find(item->image, item->rect), item->range});
  }
  return lease;
}

scheduler::Rendering from_wire(const v1::Rendering& message, const scheduler::JobGrid& grid) {
  scheduler::Rendering rendering{{message.lease_id()}, {message.job_id()}, {scheduler::kNoTile, {}}};
  if (const auto item = proto::from_proto(message.item()))
    rendering.item = {grid.find(item->image, item->rect), item->range};
  return rendering;
}

v1::Worker to_wire(const scheduler::WorkerView& worker, std::int64_t seen_ms) {
  v1::Worker message;
  message.set_id(worker.info.id.value);
  message.set_name(worker.info.name);
  message.set_threads(static_cast<std::uint32_t>(worker.info.threads));
  message.set_version(worker.info.version);
  message.set_held_leases(static_cast<std::uint32_t>(worker.held_leases));
  message.set_samples_per_second(worker.samples_per_second);
  message.set_samples_accepted(worker.samples_accepted);
  *message.mutable_last_seen_at() = timestamp_from_ms(seen_ms);
  message.set_draining(worker.draining);
  message.set_silent(worker.silent);
  message.set_audited_ranges(worker.audited_ranges);
  message.set_disproved_ranges(worker.disproved_ranges);
  message.set_stuck(worker.stuck);
  message.set_principal(worker.info.principal);
  message.set_drain_requested(worker.drain_requested);
  message.set_renders_layers(worker.info.capabilities.renders_layers);
  for (const scheduler::CooldownView& bar : worker.cooldowns) {
    auto& each = *message.add_cooldowns();
    each.set_job_id(bar.job.value);
    *each.mutable_remaining() = to_wire(bar.remaining);
    each.set_fetching(bar.fetching);
  }
  return message;
}

google::protobuf::Timestamp timestamp_from_ms(std::int64_t ms) {
  constexpr std::int64_t kFirst = TimeUtil::kTimestampMinSeconds * 1000;
  constexpr std::int64_t kLast = TimeUtil::kTimestampMaxSeconds * 1000;
  return TimeUtil::MillisecondsToTimestamp(std::clamp(ms, kFirst, kLast));
}

std::int64_t ms_from_timestamp(const google::protobuf::Timestamp& timestamp) {
  const std::int64_t seconds =
      std::clamp(timestamp.seconds(), TimeUtil::kTimestampMinSeconds, TimeUtil::kTimestampMaxSeconds);
  return seconds * 1000 + timestamp.nanos() / 1'000'000;
}

google::protobuf::Duration to_wire(scheduler::Duration duration) {
  return TimeUtil::MillisecondsToDuration(
      std::chrono::duration_cast<std::chrono::milliseconds>(duration).count());
}

double seconds(const google::protobuf::Duration& duration) {
  return static_cast<double>(duration.seconds()) + 1e-9 * duration.nanos();
}

}  // namespace tessera::farm
