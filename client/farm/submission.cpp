// SPDX-License-Identifier: Apache-2.0
#include "client/farm/submission.hpp"

#include <fmt/format.h>

#include <chrono>
#include <string>
#include <vector>

#include "client/console.hpp"
#include "client/farm/upload.hpp"
#include "client/farm/watching.hpp"
#include "proto/convert.hpp"
#include "proto/convert_display.hpp"
#include "proto/error_reasons.hpp"

namespace tessera::client {
namespace {

// How long a submission is repeated while too many scenes wait to be validated.
constexpr std::chrono::minutes kSubmitPatience{30};

// A submission keeps its request id, so that repeating it after a lost response does not create two jobs.
v1::SubmitJobRequest make_request(const Submission& submission, const LocalBundle& local) {
  v1::SubmitJobRequest request;
  request.set_request_id(fmt::format("{:016x}{:016x}", proto::random_seed(), proto::random_seed()));
  request.set_name(submission.name.empty() ? local.name : submission.name);
  *request.mutable_bundle() = local.bundle;
  *request.mutable_overrides() = proto::to_proto(submission.overrides);
  request.set_priority(submission.service.priority.value_or(0));
  request.set_max_workers(submission.service.max_workers.value_or(0));
  *request.mutable_display() = proto::to_proto(submission.display);
  request.mutable_frames()->Add(submission.frames.begin(), submission.frames.end());
  for (const auto& [key, value] : submission.labels) (*request.mutable_labels())[key] = value;
  return request;
}

// Submits the job, and returns it when its scene is validated.
core::Result<v1::Job> submit_once(Farm& farm, const Submission& submission, const LocalBundle& local) {
  if (core::Status uploaded = upload_missing(farm, local); !uploaded) return core::fail(uploaded.error());
  const v1::SubmitJobRequest request = make_request(submission, local);
  const auto call = [&] {
    return patiently<v1::SubmitJobResponse>(
        farm, [&](bool&) { return farm.call(&Farm::Stub::SubmitJob, request, kSubmitPatience); });
  };
  auto response = call();
  // The coordinator has just removed a file.
  if (!response && core::details_of(response.error()).reason == proto::kMissingBlobs) {
    const std::vector<std::string> missing = core::details_of(response.error()).missing;
    if (core::Status uploaded = upload_named(farm, local, missing); !uploaded)
      return core::fail(uploaded.error());
    response = call();
  }
  if (!response) return core::fail(response.error());
  return wait_until_validated(farm, response->job(), print_warning);
}

}  // namespace

core::Result<v1::Job> submit_job(Farm& farm, const Submission& submission, const LocalBundle& local) {
  auto job = submit_once(farm, submission, local);
  // The coordinator found a file damaged, and has removed it.
  if (job && job->failure_details().reason() == v1::Failure::REASON_FILE_LOST)
    job = submit_once(farm, submission, local);
  if (!job) return job;
  if (job->state() == v1::JOB_STATE_FAILED)
    return core::fail(core::ErrorCode::kInvalidArgument, job->failure());
  // Most warnings were printed before anything was sent.
  for (const std::string& warning : job->warnings())
    if (!has_warning(local, warning)) print_warning(warning);
  return job;
}

// A coordinator of an earlier release would ignore the layers, and render the rest.
core::Status check_features(Farm& farm, const core::RenderSettings& settings) {
  if (settings.layers.empty()) return {};
  const auto has_layers = has_feature(farm, "layers");
  if (!has_layers) return core::fail(has_layers.error());
  if (*has_layers) return {};
  return core::fail(core::ErrorCode::kFailedPrecondition,
                    fmt::format("the coordinator at {} is of an earlier release, which renders no layers: "
                                "update it, or submit the job without them (--layers none)",
                                farm.address()));
}

std::string lack_of_workers(Farm& farm, const core::RenderSettings& settings) {
  constexpr std::uint32_t kEnough = 100;  // among which one is connected, if any is
  v1::ListWorkersRequest request;
  request.set_page_size(kEnough);
  const auto page = farm.call(&Farm::Stub::ListWorkers, request);
  if (!page) return "";
  const auto is_connected = [](const v1::Worker& worker) { return !worker.silent(); };
  const auto takes_work = [](const v1::Worker& worker) { return !worker.silent() && !worker.draining(); };
  if (std::ranges::none_of(page->workers(), is_connected))
    return fmt::format("no worker is connected; the job waits for one: tessera-worker --coordinator {}",
                       farm.address());
  if (page->next_page_token().empty() && std::ranges::none_of(page->workers(), takes_work))
    return "all connected workers are drained or stopping; the job waits for another one: tessera drain "
           "--undo, or start one";
  const auto suffices = [&](const v1::Worker& worker) {
    return takes_work(worker) && (worker.renders_layers() || settings.layers.empty());
  };
  if (!page->next_page_token().empty() || std::ranges::any_of(page->workers(), suffices)) return "";
  return "no connected worker that takes work renders layers; the job waits for one: update the workers";
}

}  // namespace tessera::client
