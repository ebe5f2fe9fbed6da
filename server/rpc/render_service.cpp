// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/render_service.hpp"

#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <set>
#include <utility>

#include "server/rpc/blob_streams.hpp"
#include "server/rpc/image_stream.hpp"
#include "server/rpc/reactors.hpp"
#include "server/rpc/watch_call.hpp"

namespace tessera::rpc {

namespace {

// Puts a job into a response that has one.
template <typename Response>
core::Status put_job(core::Result<v1::Job> job, Response& response) {
  if (!job) return core::fail(job.error());
  *response.mutable_job() = std::move(*job);
  return {};
}

}  // namespace

RenderService::RenderService(server::Coordinator& coordinator, auth::AuthInterceptor& gate, Pools pools,
                             WatchHub& watches, StreamLimits& streams)
    : GuardedService("tessera.v1.RenderService", gate, streams),
      coordinator_(coordinator),
      pools_(pools),
      watches_(watches),
      streams_(streams) {
  add_unary("FindMissingBlobs", &RenderService::find_missing_blobs);
  add_unary("SubmitJob", &RenderService::submit_job);
  add_unary("GetJob", &RenderService::get_job);
  add_unary("ListJobs", &RenderService::list_jobs);
  add_unary("CancelJob", &RenderService::cancel_job);
  add_unary("PauseJob", &RenderService::pause_job);
  add_unary("ResumeJob", &RenderService::resume_job);
  add_unary("ExtendJob", &RenderService::extend_job);
  add_unary("UpdateJob", &RenderService::update_job);
  add_unary("DeleteJob", &RenderService::delete_job);
  add_unary("ListWorkers", &RenderService::list_workers);
  add("UploadBlob", [this](grpc::CallbackServerContext& context, auth::Admission admission) -> Reactor* {
    return new UploadStream(context, coordinator_, pools_, streams_, std::move(admission));
  });
  add_call("WatchJob", [this](grpc::CallbackServerContext& context, auth::Admission admission) {
    return new WatchCall(context, watches_, streams_, std::move(admission));
  });
  add_call("GetImage", [this](grpc::CallbackServerContext& context, auth::Admission admission) {
    return new ImageStream(context, coordinator_, pools_, streams_, std::move(admission));
  });
}

template <typename AnyCall, typename Pool, typename Work>
void RenderService::run_change(AnyCall& call, Pool& pool, Work work) {
  run_unary(call, pool, [this, &call, work = std::move(work)] {
    const core::Status allowed = may_change(call.caller(), call.request().job_id());
    return allowed ? work() : allowed;
  });
}

core::Status RenderService::may_change(const auth::Caller& caller, const std::string& job_id) {
  if (caller.role == auth::Role::kAdmin) return {};
  const auto job = coordinator_.jobs().get_without_bundle(job_id);
  if (!job) return core::fail(job.error());
  if (job->submitter() == caller.name) return {};
  return core::fail(core::ErrorCode::kPermissionDenied,
                    fmt::format("job {} was submitted by '{}': only they and administrators may change it",
                                job_id, job->submitter()));
}

void RenderService::submit_job(Call<v1::SubmitJobRequest, v1::SubmitJobResponse>& call) {
  // Registered now, however long the task waits.
  const std::string& key = call.caller().key;
  auto claimed = coordinator_.files().claim(key, blobs::files_of(call.request().bundle()));
  if (!claimed) return call.finish(auth::try_later(call.context(), claimed.error(), auth::kTryAgainAfter));
  const auto claim = std::make_shared<blobs::BlobClaims::Use>(*std::move(claimed));
  const auto work = [this, &call, claim] {
    core::Status submitted = put_job(
        coordinator_.jobs().submit(call.request(), call.caller().name, call.response().mutable_warnings()),
        call.response());
    if (submitted) claim->settle();
    return submitted;
  };
  run_unary(call, pools_.validating, work, [&] {
    return auth::try_later(
        call.context(),
        server::over_share(pools_.validating.waiting_of(key), "scenes", "wait to be validated",
                           streams_.limits.waiting_scenes, "--max-waiting-scenes"),
        auth::kTryAgainAfter);
  });
}

void RenderService::get_job(Call<v1::GetJobRequest, v1::GetJobResponse>& call) {
  run_unary(call, pools_.users, [this, &call] {
    return put_job(coordinator_.jobs().get(call.request().job_id()), call.response());
  });
}

void RenderService::list_jobs(Call<v1::ListJobsRequest, v1::ListJobsResponse>& call) {
  run_unary(call, pools_.users, [this, &call] {
    for (v1::Job& job : coordinator_.jobs().list(call.request()))
      *call.response().add_jobs() = std::move(job);
    return core::Status();
  });
}

void RenderService::cancel_job(Call<v1::CancelJobRequest, v1::CancelJobResponse>& call) {
  run_change(call, pools_.users, [this, &call] {
    return put_job(coordinator_.jobs().cancel(call.request().job_id()), call.response());
  });
}

void RenderService::pause_job(Call<v1::PauseJobRequest, v1::PauseJobResponse>& call) {
  run_change(call, pools_.users, [this, &call] {
    return put_job(coordinator_.jobs().pause(call.request().job_id()), call.response());
  });
}

void RenderService::resume_job(Call<v1::ResumeJobRequest, v1::ResumeJobResponse>& call) {
  run_change(call, pools_.users, [this, &call] {
    return put_job(coordinator_.jobs().resume(call.request().job_id()), call.response());
  });
}

void RenderService::extend_job(Call<v1::ExtendJobRequest, v1::ExtendJobResponse>& call) {
  run_change(call, pools_.slow, [this, &call] {
    return put_job(coordinator_.jobs().extend(call.request().job_id(), call.request().spp()),
                   call.response());
  });
}

void RenderService::update_job(Call<v1::UpdateJobRequest, v1::UpdateJobResponse>& call) {
  run_change(call, pools_.users,
             [this, &call] { return put_job(coordinator_.jobs().update(call.request()), call.response()); });
}

void RenderService::delete_job(Call<v1::DeleteJobRequest, v1::DeleteJobResponse>& call) {
  run_change(call, pools_.users,
             [this, &call] { return coordinator_.jobs().remove(call.request().job_id()); });
}

void RenderService::list_workers(Call<v1::ListWorkersRequest, v1::ListWorkersResponse>& call) {
  run_unary(call, pools_.users, [this, &call] {
    for (auto& worker : coordinator_.dispatcher().workers())
      *call.response().add_workers() = std::move(worker);
    return core::Status();
  });
}

void RenderService::find_missing_blobs(
    Call<v1::FindMissingBlobsRequest, v1::FindMissingBlobsResponse>& call) {
  run_unary(call, pools_.users, [this, &call] {
    core::Status found = find_missing(call.caller().key, call.request(), call.response());
    if (!found && found.error().code == core::ErrorCode::kResourceExhausted)
      static_cast<void>(auth::try_later(call.context(), found.error(), auth::kTryAgainAfter));
    return found;
  });
}

// Blobs in the store are claimed before they are checked, so that they are still there when the missing ones
// have been uploaded.
core::Status RenderService::find_missing(const std::string& caller,
                                         const v1::FindMissingBlobsRequest& request,
                                         v1::FindMissingBlobsResponse& response) {
  std::set<proto::Digest> files;
  for (const v1::Digest& message : request.digests()) {
    const auto digest = proto::from_proto(message);
    if (!digest) return core::fail(digest.error());
    files.insert(*digest);
  }
  const auto claimed = coordinator_.files().claim(caller, {files.begin(), files.end()});
  if (!claimed) return core::fail(claimed.error());
  for (const proto::Digest& file : files) {
    if (!coordinator_.blobs().contains(file)) *response.add_missing() = proto::to_proto(file);
  }
  return {};
}

}  // namespace tessera::rpc
