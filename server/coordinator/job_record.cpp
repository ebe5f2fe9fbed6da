// SPDX-License-Identifier: Apache-2.0
#include "server/coordinator/job_record.hpp"

#include <fmt/format.h>

#include "core/base/printable.hpp"
#include "core/scene/settings.hpp"
#include "proto/convert.hpp"
#include "proto/convert_display.hpp"
#include "server/coordinator/wire.hpp"

namespace tessera::coordinator {

namespace {

bool is_known_state(int state) {
  return v1::JobState_IsValid(state) && state != v1::JOB_STATE_UNSPECIFIED;
}

bool is_time(std::int64_t ms) {
  return ms_from_timestamp(timestamp_from_ms(ms)) == ms;
}

}  // namespace

bool is_text(const std::string& bytes) {
  v1::Job told;
  told.set_failure(bytes);
  return told.ParseFromString(told.SerializeAsString());
}

core::TileGrid grid_of(const v1::Job& spec) {
  return shape_of(spec, 0).grid();
}

scheduler::JobShape shape_of(const v1::Job& spec, std::uint32_t spp) {
  return {proto::window_of(spec.settings()), spp};
}

v1::Job describe(const JobRecord& record, const scheduler::JobView& view) {
  v1::Job job = summarise(record, view);
  *job.mutable_bundle() = record.spec->bundle();
  return job;
}

v1::Job summarise(const JobRecord& record, const scheduler::JobView& view) {
  v1::Job job;
  job.set_id(record.spec->id());
  job.set_name(record.spec->name());
  *job.mutable_settings() = record.spec->settings();
  job.mutable_settings()->set_spp(view.shape.spp);
  if (record.spec->has_display()) *job.mutable_display() = record.spec->display();
  job.set_submitter(record.spec->submitter());
  *job.mutable_created_at() = record.spec->created_at();
  job.set_state(record.unpublished_completion ? v1::JOB_STATE_RUNNING : to_wire(view.state));
  if (!record.unpublished_completion) job.set_failure(view.failure);
  job.set_priority(view.priority);
  job.set_max_workers(view.max_workers);
  job.set_samples_total(view.samples_total);
  job.set_samples_done(view.samples_done);
  job.set_samples_to_verify(view.samples_to_verify);
  job.set_samples_per_second(view.samples_per_second);
  job.set_active_workers(static_cast<std::uint32_t>(view.active_workers));
  *job.mutable_counters() = proto::to_proto(record.counters());
  if (record.finished_ms && !record.unpublished_completion)
    *job.mutable_finished_at() = timestamp_from_ms(*record.finished_ms);
  return job;
}

store::JobRow to_row(const JobRecord& record, const scheduler::JobView& view) {
  store::JobRow row;
  row.id = record.spec->id();
  row.request_id = record.request_id;
  row.spec = record.spec->SerializeAsString();
  row.revision = record.revision;
  row.state = to_wire(view.state);
  row.failure = view.failure;
  row.spp = view.shape.spp;
  row.priority = view.priority;
  row.max_workers = view.max_workers;
  row.created_ms = ms_from_timestamp(record.spec->created_at());
  row.finished_ms = record.finished_ms;
  row.counters = proto::to_proto(record.counters()).SerializeAsString();
  row.arithmetic = record.arithmetic;
  return row;
}

core::Result<JobRecord> from_row(const store::JobRow& row) {
  auto spec = std::make_shared<v1::Job>();
  v1::Counters counters;
  if (!row.intact || !spec->ParseFromString(row.spec) || !counters.ParseFromString(row.counters) ||
      spec->id() != row.id || !is_text(row.failure) || !proto::from_proto(spec->settings()) ||
      !proto::from_proto(spec->display()) || row.spp < 1 || row.spp > core::kMaxSpp ||
      !is_known_state(row.state) || !is_time(row.finished_ms.value_or(0))) {
    return core::fail(
        core::ErrorCode::kDataLoss,
        fmt::format(
            "the stored job {} is damaged: delete it and submit its scene again, or put back a copy of the "
            "state folder",
            core::printable(row.id)));
  }
  JobRecord record;
  record.spec = std::move(spec);
  record.request_id = row.request_id;
  record.revision = record.stored_revision = row.revision;
  record.finished_ms = row.finished_ms;
  record.arithmetic = row.arithmetic;
  record.stored_counters = proto::from_proto(counters);
  return record;
}

}  // namespace tessera::coordinator
