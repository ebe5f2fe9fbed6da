// SPDX-License-Identifier: Apache-2.0
#include "server/farm/job_record.hpp"

#include <fmt/format.h>

#include <utility>

#include "core/base/printable.hpp"
#include "core/scene/settings.hpp"
#include "proto/convert.hpp"
#include "proto/convert_display.hpp"
#include "server/farm/wire.hpp"

namespace tessera::farm {

namespace {

bool is_known_state(int state) {
  return v1::JobState_IsValid(state) && state != v1::JOB_STATE_UNSPECIFIED;
}

bool is_time(std::int64_t ms) {
  return ms_from_timestamp(timestamp_from_ms(ms)) == ms;
}

core::RenderCounters counters_of(const JobSnapshot& job) {
  return job.film ? job.film->counters() : job.stored_counters;
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

JobSnapshot::JobSnapshot(const JobRecord& record, scheduler::JobView job_view,
                         std::vector<std::string> job_troubles)
    : spec(record.spec),
      request_id(record.request_id),
      revision(record.revision),
      finished_ms(record.finished_ms),
      is_unpublished(record.unpublished_completion.has_value()),
      arithmetic(record.arithmetic),
      film(record.film),
      stored_counters(record.stored_counters),
      view(std::move(job_view)),
      troubles(std::move(job_troubles)) {}

v1::Job describe(const JobSnapshot& snapshot) {
  v1::Job job = summarise(snapshot);
  *job.mutable_bundle() = snapshot.spec->bundle();
  return job;
}

v1::Job summarise(const JobSnapshot& snapshot) {
  const v1::Job& spec = *snapshot.spec;
  const scheduler::JobView& view = snapshot.view;
  v1::Job job;
  job.set_id(spec.id());
  job.set_name(spec.name());
  *job.mutable_settings() = spec.settings();
  job.mutable_settings()->set_spp(view.shape.spp);
  if (spec.has_display()) *job.mutable_display() = spec.display();
  job.set_submitter(spec.submitter());
  *job.mutable_created_at() = spec.created_at();
  job.set_state(snapshot.is_unpublished ? v1::JOB_STATE_RUNNING : to_wire(view.state));
  if (!snapshot.is_unpublished) job.set_failure(view.failure);
  job.set_priority(view.priority);
  job.set_max_workers(view.max_workers);
  job.set_samples_total(view.samples_total);
  job.set_samples_done(view.samples_done);
  job.set_samples_to_verify(view.samples_to_verify);
  job.set_samples_per_second(view.samples_per_second);
  job.set_active_workers(static_cast<std::uint32_t>(view.active_workers));
  *job.mutable_counters() = proto::to_proto(counters_of(snapshot));
  if (snapshot.finished_ms && !snapshot.is_unpublished)
    *job.mutable_finished_at() = timestamp_from_ms(*snapshot.finished_ms);
  if (job.state() == v1::JOB_STATE_RUNNING)
    job.mutable_troubles()->Add(snapshot.troubles.begin(), snapshot.troubles.end());
  return job;
}

store::JobRow to_row(const JobSnapshot& job) {
  store::JobRow row;
  row.id = job.spec->id();
  row.request_id = job.request_id;
  row.spec = job.spec->SerializeAsString();
  row.revision = job.revision;
  row.state = to_wire(job.view.state);
  row.failure = job.view.failure;
  row.spp = job.view.shape.spp;
  row.priority = job.view.priority;
  row.max_workers = job.view.max_workers;
  row.created_ms = ms_from_timestamp(job.spec->created_at());
  row.finished_ms = job.finished_ms;
  row.counters = proto::to_proto(counters_of(job)).SerializeAsString();
  row.arithmetic = job.arithmetic;
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

}  // namespace tessera::farm
