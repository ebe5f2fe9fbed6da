// SPDX-License-Identifier: Apache-2.0
// The end of the state VALIDATING: the scene is validated, or the job is cancelled or deleted before.
#include <fmt/format.h>

#include <chrono>
#include <exception>
#include <new>
#include <set>
#include <utility>
#include <vector>

#include "core/base/printable.hpp"
#include "core/common/log.hpp"
#include "proto/blob.hpp"
#include "proto/convert.hpp"
#include "proto/convert_display.hpp"
#include "server/base/wall_clock.hpp"
#include "server/farm/steps.hpp"
#include "server/jobs/admission.hpp"
#include "server/jobs/job_service.hpp"

namespace tessera::jobs {

using core::ErrorCode;
using farm::JobRecord;
using farm::JobSnapshot;
using farm::kNoShape;
using farm::StateLock;
using farm::ValidatingJob;
using scheduler::FailureReason;
using scheduler::JobState;

namespace {

// How soon a validation without a result is repeated, such as one whose result could not be stored.
constexpr auto kRetryAfter = std::chrono::seconds(10);

FailureReason reason_of_code(ErrorCode code) {
  switch (code) {
    case ErrorCode::kInvalidArgument:
    case ErrorCode::kFailedPrecondition:
      return FailureReason::kInvalidScene;
    case ErrorCode::kResourceExhausted:
      return FailureReason::kLimit;
    case ErrorCode::kDataLoss:
    case ErrorCode::kNotFound:
      return FailureReason::kFileLost;
    default:
      return FailureReason::kInternal;
  }
}

scheduler::Failure failure_of(const core::Error& error) {
  return {core::printable_lines(error.message), {reason_of_code(error.code), std::nullopt, {}}};
}

// A job that the scheduler does not have yet, as the store keeps it.
JobSnapshot about_to_be(JobState state, const scheduler::JobShape& shape, const scheduler::Failure& failure,
                        const JobRecord& record) {
  scheduler::JobView view;
  view.id = {record.spec->id()};
  view.shape = shape;
  view.priority = record.spec->priority();
  view.max_workers = record.spec->max_workers();
  view.state = state;
  view.failure = failure.message;
  view.failure_details = failure.details;
  return {record, std::move(view)};
}

// Of its images.
std::vector<std::int32_t> frames_of(const v1::Job& spec) {
  std::vector<std::int32_t> frames;
  for (const v1::Image& image : spec.images()) frames.push_back(image.frame());
  return frames;
}

template <typename Check>
core::Result<v1::Job> guarded(const Check& check) {
  try {
    return check();
  } catch (const std::bad_alloc&) {
    return core::fail(ErrorCode::kResourceExhausted, "the coordinator has not enough memory for this scene");
  } catch (const std::exception& error) {
    return core::fail(ErrorCode::kInternal, error.what());
  }
}

}  // namespace

core::Error JobService::stopping() {
  return {ErrorCode::kUnavailable, "the coordinator is stopping: try again"};
}

// A file that was damaged since its upload is removed, so that it can be uploaded again. Running jobs may not
// need it any more, since their workers have it.
core::Status JobService::check_files(const v1::Bundle& bundle, const std::stop_token& stop) {
  std::set<proto::Digest> intact_ones;
  for (const v1::Bundle::Asset& asset : bundle.assets()) {
    const auto digest = proto::from_proto(asset.digest());
    if (!digest) return core::fail(digest.error());
    if (!intact_ones.insert(*digest).second) continue;
    const core::Status intact = state_.blobs.verify(*digest, stop);
    if (intact) continue;
    if (intact.error().code == ErrorCode::kDataLoss) state_.blobs.discard(*digest);
    return core::fail(intact.error().within(asset.path()));
  }
  return {};
}

core::Result<v1::Job> JobService::check_scene(const Validation& task) {
  const v1::Bundle& bundle = task.spec->bundle();
  if (auto intact = check_files(bundle, task.stop); !intact) return core::fail(intact.error());
  auto scene = check_scene_(bundle, task.submission->overrides(), frames_of(*task.spec), task.stop);
  if (!scene) return core::fail(scene.error());
  if (const auto possible = proto::from_proto(scene->settings); !possible)
    return core::fail(possible.error());
  const auto display = proto::resolve_display(scene->display, task.submission->display());
  if (!display) return core::fail(display.error());
  if (auto fits = check_image_size(scene->settings, limits_); !fits) return core::fail(fits.error());
  if (auto fits = check_spp(scene->settings.spp(), limits_); !fits) return core::fail(fits.error());
  v1::Job spec = *task.spec;
  *spec.mutable_settings() = std::move(scene->settings);
  *spec.mutable_display() = proto::to_proto(*display);
  spec.mutable_warnings()->Assign(scene->warnings.begin(), scene->warnings.end());
  spec.mutable_scene_digests()->Assign(scene->scene_digests.begin(), scene->scene_digests.end());
  spec.mutable_attributes()->Assign(scene->attributes.begin(), scene->attributes.end());
  if (auto room = check_film_memory(farm::shape_of(spec, spec.settings().spp()), film_memory_); !room)
    return core::fail(room.error());
  return spec;
}

std::vector<UnvalidatedJob> JobService::unvalidated() {
  std::vector<UnvalidatedJob> jobs;
  farm::visit_in_steps(farm_, &farm::State::validating,
                       [&](const StateLock& lock, const std::string& id, const ValidatingJob& job) {
                         if (!job.is_queued && job.next_attempt <= lock.now())
                           jobs.push_back({id, job.spec->owner()});
                       });
  return jobs;
}

bool JobService::queue_validation(const std::string& id) {
  StateLock lock(farm_);
  ValidatingJob* job = lock->find_validating(id);
  return job != nullptr && !std::exchange(job->is_queued, true);
}

std::optional<JobService::Validation> JobService::begin_validation(const std::string& id) {
  StateLock lock(farm_);
  ValidatingJob* job = lock->find_validating(id);
  if (job == nullptr || stopping_.stop_requested() || std::exchange(job->is_begun, true)) return std::nullopt;
  return Validation{job->spec, job->submission, job->stop.get_token()};
}

void JobService::validate(const std::string& id) {
  const auto task = begin_validation(id);
  if (!task) return;
  auto spec = guarded([&] { return check_scene(*task); });
  if (!spec && spec.error().code == ErrorCode::kUnavailable) return repeat_validation(id, "");
  const core::Status ended = spec ? start(*std::move(spec)) : fail_validation(id, spec.error());
  if (ended) return;
  const std::string trouble =
      fmt::format("the end of its validation could not be stored: {}; it is repeated", ended.error().message);
  common::log(spdlog::level::err, fmt::format("job {}: {}", id, trouble), {.job = id});
  repeat_validation(id, trouble);
}

void JobService::repeat_validation(const std::string& id, std::string trouble) {
  StateLock lock(farm_);
  ValidatingJob* job = lock->find_validating(id);
  if (job == nullptr) return;  // cancelled or deleted meanwhile
  job->is_queued = job->is_begun = false;
  job->next_attempt = lock.now() + kRetryAfter;
  if (job->trouble == trouble) return;
  job->trouble = std::move(trouble);
  lock.note_progress(*job);
}

core::Status JobService::fail_validation(const std::string& id, const core::Error& error) {
  const auto ended = end_unvalidated(id, JobState::kFailed, failure_of(error));
  if (ended && !*ended) return core::fail(ended->error());
  return {};
}

core::Status JobService::start(v1::Job spec) {
  const core::MutexLock one_at_a_time(submit_mutex_);
  const std::string id = spec.id();
  JobRecord record;
  record.spec = std::make_shared<const v1::Job>(std::move(spec));
  const scheduler::SubmitJob event{{id},
                                   farm::shape_of(*record.spec, record.spec->settings().spp()),
                                   record.spec->priority(),
                                   record.spec->max_workers()};
  {
    const StateLock lock(farm_);
    if (auto enough = lock.expect_memory(); !enough) return enough;
    const ValidatingJob* job = lock->find_validating(id);
    if (job == nullptr) return {};  // cancelled or deleted meanwhile
    record.request_id = job->request_id;
  }
  record.life.note(v1::JobEvent::KIND_VALIDATED, base::wall_clock_ms());
  record.revision = farm_.events().counter().next();
  record.film = film::JobFilm::make(event.shape.grid(), film_memory_, farm_.events().counter(),
                                    farm::layers_of(*record.spec));
  if (auto stored =
          state_.jobs.end_validation(farm::to_row(about_to_be(JobState::kRunning, event.shape, {}, record)));
      !stored)
    return stored;
  record.stored_revision = record.revision;
  std::map<std::string, ValidatingJob>::node_type validated;  // destroyed without the lock
  StateLock lock(farm_);
  validated = lock->remove_validating(id);
  record.files = std::move(validated.mapped().files);
  if (auto done = lock.add_job(event, std::move(record)); !done) return done;
  const v1::Job& added = *lock->find_job(id)->spec;
  lock.log(spdlog::level::info,
           fmt::format("job {} ({}) runs: {}x{} pixels, {} samples per pixel{}", id, added.name(),
                       event.shape.window.width(), event.shape.window.height(), event.shape.spp,
                       event.shape.images == 1 ? "" : fmt::format(", {} images", event.shape.images)),
           {.job = id, .principal = added.owner()});
  return {};
}

std::optional<core::Result<JobSnapshot>> JobService::end_unvalidated(const std::string& id, JobState state,
                                                                     const scheduler::Failure& failure) {
  const core::MutexLock one_at_a_time(submit_mutex_);
  JobRecord record;
  {
    const StateLock lock(farm_);
    const ValidatingJob* job = lock->find_validating(id);
    if (job == nullptr) return std::nullopt;
    if (auto enough = lock.expect_memory(); !enough) return core::fail(enough.error());
    record.spec = job->spec;
    record.request_id = job->request_id;
  }
  record.revision = farm_.events().counter().next();
  record.is_validated = false;
  record.finished_ms = base::wall_clock_ms();
  record.life.note(farm::event_of(state), *record.finished_ms);
  const scheduler::RestoreJob event{{id},
                                    kNoShape,
                                    record.spec->priority(),
                                    state,
                                    failure.message,
                                    {scheduler::IntervalSet{}},
                                    record.spec->max_workers(),
                                    {},
                                    failure.details};
  if (auto stored = state_.jobs.end_validation(farm::to_row(about_to_be(state, kNoShape, failure, record)));
      !stored)
    return core::fail(stored.error());
  record.stored_revision = record.revision;
  std::map<std::string, ValidatingJob>::node_type validated;  // destroyed without the lock
  StateLock lock(farm_);
  lock.later([stop = lock->find_validating(id)->stop]() mutable { stop.request_stop(); });
  validated = lock->remove_validating(id);
  record.files = std::move(validated.mapped().files);
  if (auto done = lock.add_job(event, std::move(record)); !done) return core::fail(done.error());
  ++lock->ended_unvalidated[static_cast<std::size_t>(state)];
  const JobRecord& added = *lock->find_job(id);
  lock.log(spdlog::level::info,
           fmt::format("job {} ({}) is {}{}{}", id, added.spec->name(), scheduler::job_state_name(state),
                       failure.message.empty() ? "" : ": ", failure.message),
           {.job = id, .principal = added.spec->owner()});
  return lock.snapshot_of(added);
}

// The job from the store first: one that is deleted only from memory would be back after a restart.
std::optional<core::Status> JobService::remove_validating(const std::string& id) {
  const core::MutexLock one_at_a_time(submit_mutex_);
  {
    const StateLock lock(farm_);
    if (lock->find_validating(id) == nullptr) return std::nullopt;
    if (auto enough = lock.expect_memory(); !enough) return enough;
  }
  if (auto deleted = state_.jobs.delete_job(id); !deleted) return deleted;
  files_.note_deleted();
  std::map<std::string, ValidatingJob>::node_type removed;  // destroyed without the lock
  StateLock lock(farm_);
  lock.later([stop = lock->find_validating(id)->stop]() mutable { stop.request_stop(); });
  removed = lock.delete_validating(id);
  lock.log(spdlog::level::info, fmt::format("job {} deleted", id), {.job = id});
  return core::Status();
}

void JobService::close() {
  stopping_.request_stop();
  std::vector<std::stop_source> validations;
  {
    const StateLock lock(farm_);
    for (const auto& [id, job] : lock->validating) validations.push_back(job.stop);
  }
  for (std::stop_source& validation : validations) validation.request_stop();
}

}  // namespace tessera::jobs
