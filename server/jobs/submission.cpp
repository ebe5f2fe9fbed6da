// SPDX-License-Identifier: Apache-2.0
// Submission of jobs.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <set>
#include <utility>

#include "proto/blob.hpp"
#include "proto/convert.hpp"
#include "proto/convert_display.hpp"
#include "proto/text.hpp"
#include "server/base/random.hpp"
#include "server/base/wall_clock.hpp"
#include "server/blobs/admission.hpp"
#include "server/farm/wire.hpp"
#include "server/jobs/admission.hpp"
#include "server/jobs/job_service.hpp"
#include "server/jobs/quota.hpp"

namespace tessera::jobs {

using core::ErrorCode;
using farm::JobRecord;
using farm::JobSnapshot;
using farm::StateLock;

namespace {

constexpr int kMaxMissingListed = 5;

// The last component of a path, the default name of a job.
std::string file_name(const std::string& path) {
  return path.substr(path.find_last_of('/') + 1);
}

}  // namespace

JobService::JobService(farm::Farm& farm, store::StateDirectory& state, blobs::SceneFiles& files,
                       const FilmReader& films, film::FilmMemory& film_memory, const server::Limits& limits,
                       SceneCheck check_scene)
    : farm_(farm),
      state_(state),
      files_(files),
      films_(films),
      film_memory_(film_memory),
      limits_(limits),
      check_scene_(std::move(check_scene)) {}

core::Status JobService::check_bundle(const v1::Bundle& bundle) {
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

core::Result<v1::Job> JobService::submit(const v1::SubmitJobRequest& request, const std::string& submitter,
                                         Texts* warnings) {
  if (auto known = answer_to_known(request.request_id(), submitter)) return *known;
  if (auto fit = proto::check_text("name", request.name()); !fit) return core::fail(fit.error());
  if (auto fit = proto::check_text("request_id", request.request_id()); !fit) return core::fail(fit.error());
  if (auto fits = blobs::check_bundle_size(request.bundle(), limits_); !fits) return core::fail(fits.error());
  const auto place = QuotaReservation::take(farm_, submitter, limits_);
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
  if (auto fits = check_picture_size(settings, limits_); !fits) return core::fail(fits.error());
  if (auto fits = check_spp(settings.spp(), limits_); !fits) return core::fail(fits.error());

  v1::Job spec;
  spec.set_id(base::random_id());
  spec.set_name(request.name().empty() ? file_name(request.bundle().scene_path()) : request.name());
  *spec.mutable_settings() = settings;
  *spec.mutable_display() = proto::to_proto(*display);
  *spec.mutable_bundle() = request.bundle();
  spec.set_priority(request.priority());
  spec.set_max_workers(request.max_workers());
  spec.set_submitter(submitter);
  *spec.mutable_created_at() = farm::timestamp_from_ms(base::wall_clock_ms());
  auto added = add(std::move(spec), request.request_id(), std::move(files));
  if (added) files_.charge_to(submitter, request.bundle());
  return added;
}

std::optional<core::Result<v1::Job>> JobService::answer_to_known(const std::string& request_id,
                                                                 const std::string& submitter) {
  const auto find_known = [&]() -> std::optional<JobSnapshot> {
    const StateLock lock(farm_);
    const auto known = lock->job_of_request.find(request_id);
    if (request_id.empty() || known == lock->job_of_request.end()) return std::nullopt;
    return lock.snapshot_of(*lock->find_job(known->second));
  };
  const auto known = find_known();
  if (!known) return std::nullopt;
  if (known->spec->submitter() == submitter) return describe(*known);
  return core::fail(ErrorCode::kAlreadyExists,
                    "another submitter has used this request_id: take a random one for each submission");
}

core::Result<v1::Job> JobService::add(v1::Job spec, const std::string& request_id,
                                      blobs::BlobClaims::Hold files) {
  const std::lock_guard one_at_a_time(submit_mutex_);
  if (auto known = answer_to_known(request_id, spec.submitter())) return *known;

  JobRecord record;
  record.spec = std::make_shared<const v1::Job>(std::move(spec));
  record.request_id = request_id;
  record.files = std::move(files);
  const core::TileGrid grid = farm::grid_of(*record.spec);
  if (auto room = check_film_memory(grid, film_memory_); !room) return core::fail(room.error());
  record.film = film::JobFilm::make(grid, film_memory_);
  scheduler::SubmitJob event{{record.spec->id()},
                             farm::shape_of(*record.spec, record.spec->settings().spp()),
                             record.spec->priority(),
                             record.spec->max_workers()};
  scheduler::JobView submitted;
  submitted.id = event.id;
  submitted.shape = event.shape;
  submitted.priority = event.priority;
  submitted.max_workers = event.max_workers;
  if (auto stored = state_.jobs.insert_job(farm::to_row({record, submitted})); !stored)
    return core::fail(stored.error());
  record.stored_revision = record.revision;

  const auto enter = [&]() -> core::Result<JobSnapshot> {
    StateLock lock(farm_);
    const scheduler::Actions actions = lock->scheduler.handle(event, lock.now());
    if (!actions.status) return core::fail(actions.status.error());
    const JobRecord& added = lock->add_job(std::move(record));
    lock.log(spdlog::level::info, fmt::format("job {} ({}) submitted: {}x{} pixels, {} samples per pixel",
                                              event.id.value, added.spec->name(), event.shape.window.width(),
                                              event.shape.window.height(), event.shape.spp));
    lock.apply(actions);
    return lock.snapshot_of(added);
  };
  const auto entered = enter();
  if (!entered) return core::fail(entered.error());
  return describe(*entered);
}

}  // namespace tessera::jobs
