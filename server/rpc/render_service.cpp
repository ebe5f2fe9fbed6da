// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/render_service.hpp"

#include <memory>
#include <utility>

#include "server/rpc/blob_calls.hpp"
#include "server/rpc/blob_streams.hpp"
#include "server/rpc/image_stream.hpp"
#include "server/rpc/job_calls.hpp"
#include "server/rpc/reactors.hpp"
#include "server/rpc/watch_calls.hpp"

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
                             ValidationQueue& validations, WatchHub& watches, StreamLimits& streams,
                             ServerFacts facts)
    : GuardedService("tessera.v1.RenderService", gate, streams),
      coordinator_(coordinator),
      pools_(pools),
      validations_(validations),
      watches_(watches),
      streams_(streams),
      facts_(std::move(facts)) {
  add_unary("FindMissingBlobs", &RenderService::find_missing_blobs);
  add_unary("BatchUploadBlobs", &RenderService::upload_batch);
  add_unary("GetUpload", &RenderService::get_upload);
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
  add_unary("GetServerInfo", &RenderService::get_server_info);
  add("UploadBlob", [this](grpc::CallbackServerContext& context, auth::Admission admission) -> Reactor* {
    return new UploadStream(context, coordinator_, pools_, streams_, std::move(admission));
  });
  add_watch<WatchJobCall>("WatchJob");
  add_watch<WatchFarmCall>("WatchFarm");
  add_watch<WatchTilesCall>("WatchTiles");
  add_call("GetImage", [this](grpc::CallbackServerContext& context, auth::Admission admission) {
    return new ImageStream(context, coordinator_, pools_, streams_, std::move(admission));
  });
}

template <typename AnyWatch>
void RenderService::add_watch(const std::string& method) {
  add_call(method, [this](grpc::CallbackServerContext& context, auth::Admission admission) {
    return new AnyWatch(context, coordinator_, watches_, pools_.watching, streams_, std::move(admission));
  });
}

template <typename AnyCall, typename Pool, typename Work>
void RenderService::run_change(AnyCall& call, Pool& pool, Work work) {
  run_unary(call, pool, [this, &call, work = std::move(work)] {
    const core::Status allowed = may_change(coordinator_, call.caller(), call.request().job_id());
    return allowed ? work() : allowed;
  });
}

void RenderService::submit_job(Call<v1::SubmitJobRequest, v1::SubmitJobResponse>& call) {
  // Registered now, however long the task waits.
  auto claimed = coordinator_.files().claim(call.caller().key, blobs::files_of(call.request().bundle()));
  if (!claimed) return call.finish(auth::try_later(call.context(), claimed.error(), auth::kTryAgainAfter));
  const auto claim = std::make_shared<blobs::BlobClaims::Use>(*std::move(claimed));
  run_unary(call, pools_.users, [this, &call, claim] {
    core::Status submitted =
        put_job(submit(coordinator_, validations_, call.request(), call.caller()), call.response());
    if (submitted) claim->settle();
    return submitted;
  });
}

void RenderService::get_job(Call<v1::GetJobRequest, v1::GetJobResponse>& call) {
  run_unary(call, pools_.users, [this, &call] {
    return put_job(coordinator_.jobs().get(call.request().job_id()), call.response());
  });
}

void RenderService::list_jobs(Call<v1::ListJobsRequest, v1::ListJobsResponse>& call) {
  run_unary(call, pools_.users, [this, &call] {
    auto listed = coordinator_.jobs().list(call.request());
    if (!listed) return core::Status(core::fail(listed.error()));
    call.response() = std::move(*listed);
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
  run_change(call, pools_.slow,
             [this, &call] { return put_job(coordinator_.jobs().extend(call.request()), call.response()); });
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
  run_unary(call, pools_.users, [this, &call]() -> core::Status {
    auto page = coordinator_.dispatcher().list_workers(call.request());
    if (!page) return core::fail(page.error());
    call.response() = *std::move(page);
    return {};
  });
}

void RenderService::get_server_info(Call<v1::GetServerInfoRequest, v1::GetServerInfoResponse>& call) {
  run_unary(call, pools_.users, [this, &call] {
    call.response() = server_info(facts_, streams_.limits, call.caller());
    return core::Status();
  });
}

void RenderService::find_missing_blobs(
    Call<v1::FindMissingBlobsRequest, v1::FindMissingBlobsResponse>& call) {
  run_unary(call, pools_.users, [this, &call] {
    return find_missing(coordinator_, call.caller().key, call.request(), call.response());
  });
}

void RenderService::upload_batch(Call<v1::BatchUploadBlobsRequest, v1::BatchUploadBlobsResponse>& call) {
  run_unary(call, pools_.slow, [this, &call] {
    return rpc::upload_batch(coordinator_, call.caller().key, streams_.limits, call.request(),
                             call.response());
  });
}

void RenderService::get_upload(Call<v1::GetUploadRequest, v1::GetUploadResponse>& call) {
  run_unary(call, pools_.users, [this, &call] {
    return rpc::get_upload(coordinator_, call.caller().key, call.request(), call.response());
  });
}

}  // namespace tessera::rpc
