// SPDX-License-Identifier: Apache-2.0
// Submission of jobs: what is checked before the scene is read, and the job in the state VALIDATING.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <set>
#include <utility>

#include "core/common/log.hpp"
#include "proto/blob.hpp"
#include "proto/convert.hpp"
#include "proto/convert_display.hpp"
#include "proto/error_reasons.hpp"
#include "proto/text.hpp"
#include "server/base/random.hpp"
#include "server/base/wall_clock.hpp"
#include "server/blobs/admission.hpp"
#include "server/farm/wire.hpp"
#include "server/jobs/admission.hpp"
#include "server/jobs/find_job.hpp"
#include "server/jobs/job_service.hpp"
#include "server/jobs/labels.hpp"
#include "server/jobs/quota.hpp"

namespace tessera::jobs {

using core::ErrorCode;
using farm::JobSnapshot;
using farm::StateLock;
using farm::ValidatingJob;

namespace {

constexpr std::size_t kMaxMissingListed = 5;

// The last component of a path, the default name of a job.
std::string file_name(const std::string& path) {
  return path.substr(path.find_last_of('/') + 1);
}

// An error of one asset, with its field.
core::Error in_asset(int index, const char* field, const core::Error& error) {
  core::ErrorDetails details = core::details_of(error);
  details.reason = proto::kInvalidField;
  details.field = fmt::format("bundle.assets[{}].{}", index, field);
  return error.with(std::move(details));
}

// INVALID_ARGUMENT if the bundle is malformed.
core::Status check_shape(const v1::Bundle& bundle) {
  std::set<std::string_view> paths;
  for (int i = 0; i < bundle.assets_size(); ++i) {
    const v1::Bundle::Asset& asset = bundle.assets(i);
    if (auto fit = proto::check_text("bundle: path", asset.path(), proto::kMaxPathBytes); !fit)
      return core::fail(in_asset(i, "path", fit.error()));
    if (const auto digest = proto::from_proto(asset.digest()); !digest)
      return core::fail(in_asset(i, "digest", digest.error().within("bundle: " + asset.path())));
    if (!paths.insert(asset.path()).second)
      return core::fail(in_asset(
          i, "path", {ErrorCode::kInvalidArgument, fmt::format("bundle: {} is named twice", asset.path())}));
  }
  if (paths.contains(bundle.scene_path())) return {};
  const core::Error error{ErrorCode::kInvalidArgument,
                          fmt::format("bundle: scene_path '{}' is none of its assets", bundle.scene_path())};
  return core::fail(error.with({.reason = proto::kInvalidField, .field = "bundle.scene_path"}));
}

// FAILED_PRECONDITION, with the blobs that are missing, each once.
core::Status check_presence(const v1::Bundle& bundle, const blobs::BlobStore& blobs) {
  std::set<proto::Digest> checked;
  std::string listed;
  core::ErrorDetails details{.reason = proto::kMissingBlobs};
  for (const v1::Bundle::Asset& asset : bundle.assets()) {
    const proto::Digest digest = *proto::from_proto(asset.digest());
    if (!checked.insert(digest).second || blobs.contains(digest)) continue;
    details.missing.push_back(proto::blob_name(digest));
    if (details.missing.size() <= kMaxMissingListed)
      listed += fmt::format("\n  {} ({})", asset.path(), digest.hex());
  }
  const std::size_t count = details.missing.size();
  if (count == 0) return {};
  const core::Error error{ErrorCode::kFailedPrecondition,
                          fmt::format("{} blobs are missing here; upload them and submit again:{}{}", count,
                                      listed, count > kMaxMissingListed ? "\n  ..." : "")};
  return core::fail(error.with(std::move(details)));
}

// Overrides whose form is wrong. Whether they fit the scene is checked with it.
core::Status check_overrides(const v1::SubmitJobRequest& request) {
  const auto refuse = [](const char* field, const core::Error& error) {
    return core::fail(error.with({.reason = proto::kInvalidField, .field = field}));
  };
  if (const auto overrides = proto::from_proto(request.overrides()); !overrides)
    return refuse("overrides", overrides.error());
  if (const auto display = proto::resolve_display({}, request.display()); !display)
    return refuse("display", display.error());
  return {};
}

// INVALID_ARGUMENT if a frame is named twice.
core::Status check_frames(const v1::SubmitJobRequest& request) {
  std::set<std::int32_t> frames;
  for (const std::int32_t frame : request.frames()) {
    if (frames.insert(frame).second) continue;
    const core::Error error{ErrorCode::kInvalidArgument, fmt::format("frames: {} is named twice", frame)};
    return core::fail(error.with({.reason = proto::kInvalidField, .field = "frames"}));
  }
  return {};
}

// What is known of the settings before the scene is read.
v1::RenderSettings settings_of(const v1::RenderOverrides& overrides) {
  v1::RenderSettings settings;
  settings.set_width_px(overrides.width_px());
  settings.set_height_px(overrides.height_px());
  settings.set_spp(overrides.spp());
  settings.set_seed(overrides.seed());
  settings.set_integrator(overrides.integrator());
  settings.set_heuristic(overrides.heuristic());
  if (overrides.has_crop()) *settings.mutable_crop() = overrides.crop();
  settings.set_clamp_indirect(overrides.clamp_indirect());
  return settings;
}

ValidatingJob make_job(const v1::SubmitJobRequest& request, const std::string& owner) {
  auto spec = std::make_shared<v1::Job>();
  spec->set_id(base::random_id());
  spec->set_name(request.name().empty() ? file_name(request.bundle().scene_path()) : request.name());
  *spec->mutable_settings() = settings_of(request.overrides());
  *spec->mutable_bundle() = request.bundle();
  spec->set_priority(request.priority());
  spec->set_max_workers(request.max_workers());
  spec->set_owner(owner);
  *spec->mutable_labels() = request.labels();
  for (const std::int32_t frame : request.frames()) spec->add_images()->set_frame(frame);
  spec->set_image_count(static_cast<std::uint32_t>(request.frames_size()));
  *spec->mutable_created_at() = farm::timestamp_from_ms(base::wall_clock_ms());
  auto submission = std::make_shared<v1::SubmitJobRequest>();
  *submission->mutable_overrides() = request.overrides();
  *submission->mutable_display() = request.display();
  ValidatingJob job{.spec = std::move(spec), .submission = std::move(submission)};
  job.request_id = request.request_id();
  job.is_queued = true;
  return job;
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

core::Status JobService::check_request(const v1::SubmitJobRequest& request) const {
  if (stopping_.stop_requested()) return core::fail(stopping());
  if (auto fit = proto::check_text("name", request.name()); !fit) return fit;
  if (auto fit = proto::check_text("request_id", request.request_id()); !fit) return fit;
  if (auto fit = check_labels(request.labels()); !fit) return fit;
  if (auto fit = check_overrides(request); !fit) return fit;
  if (auto fit = check_frames(request); !fit) return fit;
  if (auto fit = check_image_count(static_cast<std::uint64_t>(request.frames_size()), limits_); !fit)
    return fit;
  return blobs::check_bundle_size(request.bundle(), limits_);
}

core::Result<v1::Job> JobService::submit(const v1::SubmitJobRequest& request, const std::string& owner,
                                         const std::string& peer) {
  if (auto known = find_submission(request.request_id(), owner)) return *known;
  if (auto fine = check_request(request); !fine) return core::fail(fine.error());
  const auto place = QuotaReservation::take(farm_, owner, limits_);
  if (!place) return core::fail(place.error());
  auto files = files_.hold(request.bundle());
  if (auto shaped = check_shape(request.bundle()); !shaped) return core::fail(shaped.error());
  if (auto here = check_presence(request.bundle(), state_.blobs); !here) return core::fail(here.error());
  ValidatingJob job = make_job(request, owner);
  job.files = std::move(files);
  return add(std::move(job), peer);
}

std::optional<core::Result<v1::Job>> JobService::find_submission(const std::string& request_id,
                                                                 const std::string& owner) {
  if (request_id.empty()) return std::nullopt;
  const auto known = find_known(request_id);
  if (!known) return core::fail(known.error());
  if (!*known) return std::nullopt;
  if ((*known)->spec->owner() == owner) return describe(**known);
  return core::fail(ErrorCode::kAlreadyExists,
                    "another owner has used this request_id: take a random one for each submission");
}

core::Result<std::optional<JobSnapshot>> JobService::find_known(const std::string& request_id) {
  {
    const StateLock lock(farm_);
    const auto known = lock->job_of_request.find(request_id);
    if (known != lock->job_of_request.end())
      return std::optional(find_in_memory(lock, known->second)->snapshot);
  }
  const auto row = state_.jobs.job_of_request(request_id);
  if (!row) return core::fail(row.error());
  if (!*row) return std::optional<JobSnapshot>();
  return std::optional(farm::snapshot_of_row(**row));
}

core::Result<v1::Job> JobService::add(ValidatingJob job, const std::string& peer) {
  const core::MutexLock one_at_a_time(submit_mutex_);
  const auto spec = job.spec;
  if (auto known = find_submission(job.request_id, spec->owner())) return *known;
  job.revision = farm_.events().counter().next();
  if (auto stored = state_.jobs.insert_job(farm::to_row(job)); !stored) return core::fail(stored.error());
  files_.charge_to(spec->owner(), spec->bundle());
  const JobSnapshot added = [&] {
    StateLock lock(farm_);
    lock.add_validating(std::move(job));
    return find_in_memory(lock, spec->id())->snapshot;
  }();
  common::log(spdlog::level::info, fmt::format("job {} ({}) submitted", spec->id(), spec->name()),
              {.job = spec->id(), .principal = spec->owner(), .peer = peer});
  return describe(added);
}

}  // namespace tessera::jobs
