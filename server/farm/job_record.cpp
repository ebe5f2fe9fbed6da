// SPDX-License-Identifier: Apache-2.0
#include "server/farm/job_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/base/printable.hpp"
#include "core/scene/settings.hpp"
#include "proto/convert.hpp"
#include "proto/convert_display.hpp"
#include "server/farm/stored_job.hpp"
#include "server/farm/wire.hpp"
#include "server/film/stored_counters.hpp"

namespace tessera::farm {

namespace {

bool is_known_state(int state) {
  return v1::JobState_IsValid(state) && state != v1::JOB_STATE_UNSPECIFIED;
}

// The row of a job that was never validated has no samples per pixel.
bool is_validated(const store::JobRow& row) {
  return row.spp > 0;
}

bool has_valid_settings(const store::JobRow& row, const v1::Job& spec) {
  return row.spp <= core::kMaxSpp && proto::from_proto(spec.settings()).has_value();
}

// Whether the film has no more tiles than one can have, and the targets are of these.
bool has_possible_shape(const store::JobRow& row, const v1::Job& spec) {
  const auto targets = decode_targets(row.targets);
  if (!targets || spec.image_count() > scheduler::kMaxTilesPerJob) return false;
  const scheduler::JobGrid grid = grid_of(spec);
  const std::int64_t tiles = std::int64_t{grid.tiles_per_image()} * grid.image_count();
  const auto& all = targets->all();
  return tiles <= scheduler::kMaxTilesPerJob && (all.empty() || all.back().tile < tiles);
}

bool ended_unvalidated(const store::JobRow& row) {
  return row.state == v1::JOB_STATE_CANCELLED || row.state == v1::JOB_STATE_FAILED;
}

bool is_time(std::int64_t ms) {
  return ms_from_timestamp(timestamp_from_ms(ms)) == ms;
}

void say_what_is_ahead(const JobSnapshot& snapshot, v1::Job& job) {
  if (!snapshot.scenes_ahead) return job.set_waiting_reason("validating");
  job.set_queue_position(static_cast<std::uint32_t>(1 + *snapshot.scenes_ahead));
  job.set_waiting_reason(fmt::format("validating: {} ahead", *snapshot.scenes_ahead));
}

core::RenderCounters counters_of(const JobSnapshot& job) {
  return job.film ? job.film->counters() : job.stored_counters;
}

std::vector<std::uint64_t> samples_by_image(const JobSnapshot& job) {
  return job.film ? job.film->samples_by_image() : job.stored_samples_by_image;
}

// Samples of a running job that were just counted may not be in its film yet.
void add_images(const JobSnapshot& snapshot, v1::Job& job) {
  const scheduler::JobShape& shape = snapshot.view.shape;
  const bool is_done = job.state() == v1::JOB_STATE_DONE;
  const std::vector<std::uint64_t> samples = samples_by_image(snapshot);
  const int count = static_cast<int>(job.image_count());
  const core::LayerSet layers = layers_of(*snapshot.spec);
  for (int i = 0; i < count; ++i) {
    v1::Image& image = *job.add_images();
    if (i < snapshot.spec->images_size()) image = snapshot.spec->images(i);
    if (!snapshot.is_validated) continue;
    const auto at = static_cast<std::size_t>(i);
    if (i == 0 && !layers.empty()) *image.mutable_layout() = proto::to_proto(core::film_layout(layers));
    const std::uint64_t total = shape.pixel_samples_of(i);
    const std::uint64_t known = count == 1 ? job.samples_done() : at < samples.size() ? samples[at] : 0;
    image.set_samples_total(total);
    image.set_samples_done(is_done ? total : known);
  }
}

// A job of an earlier release has its end alone. That of a job whose completion is unpublished is left out.
void add_events(const JobSnapshot& snapshot, v1::Job& job) {
  const auto add = [&job](v1::JobEvent::Kind kind, const google::protobuf::Timestamp& at) {
    v1::JobEvent& event = *job.add_events();
    event.set_kind(kind);
    *event.mutable_at() = at;
  };
  add(v1::JobEvent::KIND_SUBMITTED, job.created_at());
  std::vector<JobLife::Event> events = snapshot.life.events();
  if (snapshot.is_unpublished && !events.empty() && is_end(events.back().kind)) events.pop_back();
  for (const JobLife::Event& each : events) add(each.kind, timestamp_from_ms(each.at_ms));
  if (events.empty() && job.has_finished_at()) add(event_of(snapshot.view.state), job.finished_at());
}

stored::v1::Counters stored_counters_of(const JobSnapshot& job) {
  stored::v1::Counters counters = film::to_stored(counters_of(job));
  const std::vector<std::uint64_t> samples = samples_by_image(job);
  if (samples.size() > 1) counters.mutable_samples_by_image()->Add(samples.begin(), samples.end());
  write_life(job.life, counters);
  return counters;
}

}  // namespace

bool has_all_samples(const JobSnapshot& snapshot) {
  return snapshot.view.shape.targets.all().empty() && snapshot.view.state == scheduler::JobState::kDone &&
         !snapshot.is_unpublished;
}

bool is_text(const std::string& bytes) {
  v1::Job told;
  told.set_failure(bytes);
  return told.ParseFromString(told.SerializeAsString());
}

core::LayerSet layers_of(const v1::Job& spec) {
  return proto::layers_from(spec.settings().layers()).value_or(core::LayerSet());
}

scheduler::JobGrid grid_of(const v1::Job& spec) {
  return shape_of(spec, 0).grid();
}

scheduler::JobShape shape_of(const v1::Job& spec, std::uint32_t spp) {
  scheduler::JobShape shape{proto::window_of(spec.settings()), spp,
                            static_cast<int>(std::max(spec.image_count(), 1U))};
  shape.has_layers = !spec.settings().layers().empty();
  return shape;
}

scheduler::JobShape shape_of(const v1::Job& spec, const store::JobRow& row) {
  scheduler::JobShape shape = shape_of(spec, row.spp);
  shape.targets = decode_targets(row.targets).value_or(scheduler::TileTargets());
  return shape;
}

JobSnapshot::JobSnapshot(const JobRecord& record, scheduler::JobView job_view,
                         std::vector<std::string> job_troubles)
    : spec(record.spec),
      is_validated(record.is_validated),
      request_id(record.request_id),
      revision(record.revision),
      last_event(record.last_event),
      finished_ms(record.finished_ms),
      is_unpublished(record.unpublished_completion.has_value()),
      arithmetic(record.arithmetic),
      film(record.film),
      stored_counters(record.stored_counters),
      stored_samples_by_image(record.stored_samples_by_image),
      life(record.life),
      view(std::move(job_view)),
      troubles(std::move(job_troubles)) {}

v1::Job describe(const JobSnapshot& snapshot) {
  v1::Job job = describe_without_bundle(snapshot);
  *job.mutable_bundle() = snapshot.spec->bundle();
  *job.mutable_scene_digests() = snapshot.spec->scene_digests();
  *job.mutable_attributes() = snapshot.spec->attributes();
  return job;
}

v1::Job describe_without_bundle(const JobSnapshot& snapshot) {
  v1::Job job = summarise(snapshot);
  *job.mutable_warnings() = snapshot.spec->warnings();
  add_images(snapshot, job);
  add_events(snapshot, job);
  return job;
}

v1::Job summarise_spec(const v1::Job& spec) {
  v1::Job job;
  job.set_id(spec.id());
  job.set_name(spec.name());
  *job.mutable_settings() = spec.settings();
  if (spec.has_display()) *job.mutable_display() = spec.display();
  job.set_priority(spec.priority());
  job.set_max_workers(spec.max_workers());
  job.set_owner(spec.owner());
  *job.mutable_labels() = spec.labels();
  *job.mutable_created_at() = spec.created_at();
  job.set_image_count(std::max(spec.image_count(), 1U));
  return job;
}

v1::Job summarise(const JobSnapshot& snapshot) {
  const scheduler::JobView& view = snapshot.view;
  v1::Job job = summarise_spec(*snapshot.spec);
  job.set_revision(snapshot.last_event);
  if (snapshot.is_validating) {
    job.set_state(v1::JOB_STATE_VALIDATING);
    say_what_is_ahead(snapshot, job);
    job.mutable_troubles()->Add(snapshot.troubles.begin(), snapshot.troubles.end());
    return job;
  }
  if (snapshot.is_validated) job.mutable_settings()->set_spp(view.shape.spp);
  job.set_state(snapshot.is_unpublished ? v1::JOB_STATE_RUNNING : to_wire(view.state));
  if (job.state() == v1::JOB_STATE_FAILED) {
    job.set_failure(view.failure);
    *job.mutable_failure_details() = to_wire({view.failure, view.failure_details}, view.shape.grid());
  }
  job.set_priority(view.priority);
  job.set_max_workers(view.max_workers);
  if (snapshot.is_validated) job.set_samples_total(view.samples_total);
  job.set_samples_done(view.samples_done);
  job.set_samples_to_verify(view.samples_to_verify);
  job.set_samples_per_second(view.samples_per_second);
  job.set_active_workers(static_cast<std::uint32_t>(view.active_workers));
  job.set_queue_position(view.queue_position);
  job.set_waiting_reason(std::string(waiting_reason(view.waiting)));
  *job.mutable_counters() = proto::to_proto(counters_of(snapshot));
  if (snapshot.finished_ms && !snapshot.is_unpublished)
    *job.mutable_finished_at() = timestamp_from_ms(*snapshot.finished_ms);
  if (job.state() == v1::JOB_STATE_RUNNING)
    job.mutable_troubles()->Add(snapshot.troubles.begin(), snapshot.troubles.end());
  return job;
}

store::JobRow to_row(const JobSnapshot& job) {
  store::JobRow row;
  write_spec(*job.spec, row);
  row.request_id = job.request_id;
  row.revision = job.revision;
  row.state = to_wire(job.view.state);
  row.failure = job.view.failure;
  row.spp = job.is_validated ? job.view.shape.spp : 0;
  if (job.view.state == scheduler::JobState::kFailed)
    row.failure_details = encode_failure(job.view.failure_details);
  row.priority = job.view.priority;
  row.max_workers = job.view.max_workers;
  row.finished_ms = job.finished_ms;
  row.counters = stored_counters_of(job).SerializeAsString();
  if (job.is_validated) row.targets = encode_targets(job.view.shape.targets);
  row.arithmetic = job.arithmetic;
  if (job.film) row.producers = job.film->producers().encode();
  return row;
}

void write_spec(const v1::Job& spec, store::JobRow& row) {
  row.id = spec.id();
  row.spec = encode_spec(spec);
  row.bundle = encode_bundle(spec);
  row.owner = spec.owner();
  row.created_ms = ms_from_timestamp(spec.created_at());
}

// Rows of earlier releases have the bundle in their spec.
bool read_spec(const store::JobRow& row, v1::Job& spec) {
  return decode_spec(row.spec, spec) && spec.id() == row.id &&
         (row.bundle.empty() || decode_bundle(row.bundle, spec));
}

core::Error damaged_job(const std::string& id) {
  return {
      core::ErrorCode::kDataLoss,
      fmt::format("the stored job {} is damaged: delete it and submit its scene again, or put back a copy of "
                  "the state folder",
                  core::printable(id))};
}

core::Result<JobRecord> from_row(const store::JobRow& row) {
  auto spec = std::make_shared<v1::Job>();
  stored::v1::Counters counters;
  if (!row.intact || !read_spec(row, *spec) || !counters.ParseFromString(row.counters) ||
      !is_text(row.failure) || !proto::from_proto(spec->display()) ||
      !(is_validated(row) ? has_valid_settings(row, *spec) && has_possible_shape(row, *spec)
                          : ended_unvalidated(row)) ||
      !is_known_state(row.state) || !is_time(row.finished_ms.value_or(0)))
    return core::fail(damaged_job(row.id));
  JobRecord record;
  record.is_validated = is_validated(row);
  record.spec = std::move(spec);
  record.request_id = row.request_id;
  record.revision = record.stored_revision = record.last_event = row.revision;
  record.finished_ms = row.finished_ms;
  record.arithmetic = row.arithmetic;
  record.stored_counters = film::from_stored(counters);
  record.stored_samples_by_image.assign(counters.samples_by_image().begin(),
                                        counters.samples_by_image().end());
  record.life = read_life(counters);
  return record;
}

JobRecord record_of_damaged(const store::JobRow& row) {
  auto spec = std::make_shared<v1::Job>();
  spec->set_id(row.id);
  spec->set_name("(damaged)");
  spec->mutable_settings()->set_width_px(1);
  spec->mutable_settings()->set_height_px(1);
  *spec->mutable_created_at() = timestamp_from_ms(row.created_ms);
  if (const auto readable = from_row(row)) {
    *spec->mutable_bundle() = readable->spec->bundle();
    spec->set_owner(readable->spec->owner());
  }
  JobRecord record;
  record.spec = std::move(spec);
  record.request_id = row.request_id;
  record.revision = record.stored_revision = record.last_event = row.revision;
  record.finished_ms = row.finished_ms;
  record.row_is_left = true;
  return record;
}

JobSnapshot snapshot_of_damaged(const store::JobRow& row, const core::Error& error) {
  using scheduler::FailureReason;
  const bool is_limit = error.code == core::ErrorCode::kResourceExhausted;
  scheduler::JobView view;
  view.id = {row.id};
  view.shape = kNoShape;
  view.state = scheduler::JobState::kFailed;
  view.failure = error.message;
  view.failure_details.reason = is_limit ? FailureReason::kLimit : FailureReason::kFilmLost;
  view.priority = row.priority;
  view.max_workers = row.max_workers;
  return {record_of_damaged(row), std::move(view)};
}

}  // namespace tessera::farm
