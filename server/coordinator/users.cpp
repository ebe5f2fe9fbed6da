// SPDX-License-Identifier: Apache-2.0
// The users' methods of the coordinator.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "proto/blob.hpp"
#include "proto/convert.hpp"
#include "proto/convert_display.hpp"
#include "proto/text.hpp"
#include "server/coordinator/admission.hpp"
#include "server/coordinator/quota_reservation.hpp"
#include "server/coordinator/state_lock.hpp"
#include "server/coordinator/wire.hpp"

namespace tessera::coordinator {

using core::ErrorCode;

namespace {

constexpr int kMaxMissingListed = 5;

std::int64_t wall_now_ms() {
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::milliseconds>(since_1970).count();
}

// The last component of a path, the default name of a job.
std::string file_name(const std::string& path) {
  return path.substr(path.find_last_of('/') + 1);
}

}  // namespace

core::Status Coordinator::check_bundle(const v1::Bundle& bundle) {
  std::set<std::string> paths;
  std::set<proto::Digest> intact_ones;
  std::string missing;
  int missing_count = 0;
  for (const v1::Bundle::Asset& asset : bundle.assets()) {
    if (auto fit = proto::check_text("bundle: path", asset.path(), proto::kMaxPathBytes); !fit) return fit;
    const auto digest = proto::from_proto(asset.digest());
    if (!digest) return core::fail(digest.error().within("bundle: " + asset.path()));
    if (!paths.insert(asset.path()).second) {
      return core::fail(ErrorCode::kInvalidArgument, fmt::format("bundle: {} is named twice", asset.path()));
    }
    if (intact_ones.contains(*digest)) continue;
    const core::Status intact = state_.blobs.verify(*digest, stopping_.get_token());
    if (intact) {
      intact_ones.insert(*digest);
      continue;
    }
    // A file that was damaged since its upload counts as missing. Running jobs may not need it any more,
    // since their workers have it.
    const ErrorCode code = intact.error().code;
    if (code != ErrorCode::kDataLoss && code != ErrorCode::kNotFound) return core::fail(intact.error());
    if (code == ErrorCode::kDataLoss) state_.blobs.discard(*digest);
    if (++missing_count <= kMaxMissingListed)
      missing += fmt::format("\n  {} ({})", asset.path(), digest->hex());
  }
  if (paths.count(bundle.scene_path()) == 0) {
    return core::fail(ErrorCode::kInvalidArgument,
                      fmt::format("bundle: scene_path '{}' is none of its assets", bundle.scene_path()));
  }
  if (missing_count == 0) return {};
  return core::fail(ErrorCode::kFailedPrecondition,
                    fmt::format("{} blobs are missing here; upload them and submit again:{}{}", missing_count,
                                missing, missing_count > kMaxMissingListed ? "\n  ..." : ""));
}

core::Result<v1::Job> Coordinator::submit_job(const v1::SubmitJobRequest& request,
                                              const std::string& submitter, Texts* warnings) {
  if (auto known = answer_to_known(request.request_id(), submitter)) return *known;
  if (auto fit = proto::check_text("name", request.name()); !fit) return core::fail(fit.error());
  if (auto fit = proto::check_text("request_id", request.request_id()); !fit) return core::fail(fit.error());
  if (auto fits = check_bundle_size(request.bundle(), options_.limits); !fits)
    return core::fail(fits.error());
  const auto place = reserve_quota(submitter);
  if (!place) return core::fail(place.error());
  auto files = files_.hold(request.bundle());
  if (auto checked = check_bundle(request.bundle()); !checked) return core::fail(checked.error());
  const auto scene = check_scene_(request.bundle(), request.overrides());
  if (!scene) return core::fail(scene.error());
  if (warnings != nullptr) warnings->Add(scene->warnings.begin(), scene->warnings.end());
  const v1::RenderSettings& settings = scene->settings;
  if (const auto possible = proto::from_proto(settings); !possible) return core::fail(possible.error());
  const auto display = proto::resolve_display(scene->display, request.display());
  if (!display) return core::fail(display.error());
  if (auto fits = check_picture_size(settings, options_.limits); !fits) return core::fail(fits.error());
  if (auto fits = check_spp(settings.spp(), options_.limits); !fits) return core::fail(fits.error());

  v1::Job spec;
  spec.set_id(random_id());
  spec.set_name(request.name().empty() ? file_name(request.bundle().scene_path()) : request.name());
  *spec.mutable_settings() = settings;
  *spec.mutable_display() = proto::to_proto(*display);
  *spec.mutable_bundle() = request.bundle();
  spec.set_priority(request.priority());
  spec.set_max_workers(request.max_workers());
  spec.set_submitter(submitter);
  *spec.mutable_created_at() = timestamp_from_ms(wall_now_ms());
  auto added = add_job(std::move(spec), request.request_id(), std::move(files));
  if (added) files_.charge_to(submitter, request.bundle());
  return added;
}

std::optional<core::Result<v1::Job>> Coordinator::answer_to_known(const std::string& request_id,
                                                                  const std::string& submitter) {
  const StateLock lock(*this);
  const auto known = job_of_request_.find(request_id);
  if (request_id.empty() || known == job_of_request_.end()) return std::nullopt;
  v1::Job job = describe_now(lock, jobs_.at(known->second));
  if (job.submitter() == submitter) return job;
  return core::fail(ErrorCode::kAlreadyExists,
                    "another submitter has used this request_id: take a random one for each submission");
}

core::Result<v1::Job> Coordinator::add_job(v1::Job spec, const std::string& request_id,
                                           BlobClaims::Hold files) {
  const std::lock_guard one_at_a_time(submit_mutex_);
  if (auto known = answer_to_known(request_id, spec.submitter())) return *known;

  JobRecord record;
  record.spec = std::make_shared<const v1::Job>(std::move(spec));
  record.request_id = request_id;
  record.files = std::move(files);
  record.film = std::make_unique<JobFilm>(grid_of(*record.spec));
  scheduler::SubmitJob event{{record.spec->id()},
                             shape_of(*record.spec, record.spec->settings().spp()),
                             record.spec->priority(),
                             record.spec->max_workers()};
  scheduler::JobView submitted;
  submitted.id = event.id;
  submitted.shape = event.shape;
  submitted.priority = event.priority;
  submitted.max_workers = event.max_workers;
  if (auto stored = state_.jobs.insert_job(to_row(record, submitted)); !stored)
    return core::fail(stored.error());
  record.stored_revision = record.revision;

  StateLock lock(*this);
  const scheduler::Actions actions = scheduler_.handle(event, lock.now());
  if (!actions.status) return core::fail(actions.status.error());
  if (!request_id.empty()) job_of_request_[request_id] = event.id.value;
  const JobRecord& added = jobs_.emplace(event.id.value, std::move(record)).first->second;
  spdlog::info("job {} ({}) submitted: {}x{} pixels, {} samples per pixel", event.id.value,
               added.spec->name(), event.shape.window.width(), event.shape.window.height(), event.shape.spp);
  apply(lock, actions);
  return describe_now(lock, added);
}

core::Result<Coordinator::ChangedJob> Coordinator::change(StateLock& lock, const std::string& id,
                                                          const scheduler::Event& event) {
  const scheduler::Actions actions = scheduler_.handle(event, lock.now());
  apply(lock, actions);
  if (!actions.status) return core::fail(actions.status.error());
  JobRecord& record = *find(id);
  ++record.revision;
  return ChangedJob{describe_now(lock, record), to_row(record, *scheduler_.job({id}, lock.now()))};
}

core::Result<v1::Job> Coordinator::store_change(core::Result<ChangedJob> changed) {
  if (!changed) return core::fail(changed.error());
  if (auto stored = state_.jobs.update_job(changed->row); !stored) {
    return core::fail(stored.error().within("the job was changed, but a crash would undo it"));
  }
  return std::move(changed->job);
}

core::Result<v1::Job> Coordinator::change_job(const std::string& id, const scheduler::Event& event) {
  const auto changed = [&] {
    StateLock lock(*this);
    return change(lock, id, event);
  };
  return store_change(changed());
}

core::Result<v1::Job> Coordinator::cancel_job(const std::string& id) {
  return change_job(id, scheduler::CancelJob{{id}});
}

core::Result<v1::Job> Coordinator::pause_job(const std::string& id) {
  return change_job(id, scheduler::PauseJob{{id}});
}

core::Result<v1::Job> Coordinator::resume_job(const std::string& id) {
  return change_job(id, scheduler::ResumeJob{{id}});
}

core::Result<v1::Job> Coordinator::update_job(const v1::UpdateJobRequest& request) {
  scheduler::UpdateJob event{{request.job_id()}, {}, {}};
  if (request.has_priority()) event.priority = request.priority();
  if (request.has_max_workers()) event.max_workers = request.max_workers();
  auto updated = change_job(request.job_id(), event);
  if (updated)
    spdlog::info("job {} ({}) has priority {} and at most {} workers (0: any number)", updated->id(),
                 updated->name(), updated->priority(), updated->max_workers());
  return updated;
}

core::Status Coordinator::delete_job(const std::string& id) {
  // From the store first: a job that is deleted only from memory would be back after a restart.
  if (const auto known = job(id); !known) return core::fail(known.error());
  if (const core::Status deleted = state_.jobs.delete_job(id); !deleted) return deleted;
  std::map<std::string, JobRecord>::node_type deleted_one;  // destroyed outside the lock
  StateLock lock(*this);
  const scheduler::Actions actions = scheduler_.handle(scheduler::DeleteJob{{id}}, lock.now());
  apply(lock, actions);
  if (!actions.status) return actions.status;
  job_of_request_.erase(jobs_.at(id).request_id);
  deleted_one = jobs_.extract(id);
  spdlog::info("job {} deleted", id);
  return {};
}

}  // namespace tessera::coordinator
