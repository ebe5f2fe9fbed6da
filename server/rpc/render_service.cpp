// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/render_service.hpp"

#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <set>
#include <utility>

#include "server/rpc/blob_streams.hpp"
#include "server/rpc/image_stream.hpp"
#include "server/rpc/watch_call.hpp"

namespace tessera::rpc {

namespace {

// Puts a job into a response that has one.
template <typename Response>
core::Status put_job(core::Result<v1::Job> job, Response* response) {
  if (!job) return core::fail(job.error());
  *response->mutable_job() = std::move(*job);
  return {};
}

}  // namespace

template <typename Pool, typename Work, typename WhenFull>
grpc::ServerUnaryReactor* RenderService::serve(grpc::CallbackServerContext* context, Pool& pool, Work work,
                                               WhenFull when_full) {
  Caller caller;
  if (const auto admitted = auth_.admit(*context, Role::kSubmit, caller); !admitted.ok())
    return refuse(context, admitted);
  return run_unary(
      context, pool, caller.key, [caller, work = std::move(work)] { return work(caller); },
      [&] { return when_full(caller); });
}

template <typename Pool, typename Work>
grpc::ServerUnaryReactor* RenderService::serve(grpc::CallbackServerContext* context, Pool& pool, Work work) {
  return serve(context, pool, std::move(work), [](const Caller&) { return busy(); });
}

template <typename Pool, typename Work>
grpc::ServerUnaryReactor* RenderService::serve_change(grpc::CallbackServerContext* context, Pool& pool,
                                                      const std::string& job_id, Work work) {
  return serve(context, pool, [this, &job_id, work = std::move(work)](const Caller& caller) {
    const core::Status allowed = may_change(caller, job_id);
    return allowed ? work() : allowed;
  });
}

core::Status RenderService::may_change(const Caller& caller, const std::string& job_id) {
  if (caller.role == Role::kAdmin) return {};
  const auto job = coordinator_.job_without_bundle(job_id);
  if (!job) return core::fail(job.error());
  if (job->submitter() == caller.name) return {};
  return core::fail(core::ErrorCode::kPermissionDenied,
                    fmt::format("job {} was submitted by '{}': only they and administrators may change it",
                                job_id, job->submitter()));
}

grpc::ServerReadReactor<v1::UploadBlobRequest>* RenderService::UploadBlob(
    grpc::CallbackServerContext* context, v1::UploadBlobResponse* response) {
  Caller caller;
  if (const auto admitted = auth_.admit(*context, Role::kSubmit, caller); !admitted.ok())
    return new RefusedStream<grpc::ServerReadReactor<v1::UploadBlobRequest>>(admitted);
  auto place = streams_.uploads.take(caller.key);
  if (!place) {
    return new RefusedStream<grpc::ServerReadReactor<v1::UploadBlobRequest>>(
        try_later(*context,
                  server::over_share(streams_.uploads.held_by(caller.key), "uploads", "are under way",
                                     streams_.limits.uploads, "--max-uploads"),
                  kTryAgainAfter));
  }
  return new UploadStream(*context, coordinator_, pools_, streams_,
                          {caller.key, *std::move(place), response});
}

grpc::ServerUnaryReactor* RenderService::SubmitJob(grpc::CallbackServerContext* context,
                                                   const v1::SubmitJobRequest* request,
                                                   v1::SubmitJobResponse* response) {
  Caller caller;
  if (const auto admitted = auth_.admit(*context, Role::kSubmit, caller); !admitted.ok())
    return refuse(context, admitted);
  // From now on, however long it waits for its turn.
  auto claimed = coordinator_.files().claim(caller.key, coordinator::files_of(request->bundle()));
  if (!claimed) return refuse(context, try_later(*context, claimed.error(), kTryAgainAfter));
  const auto claim = std::make_shared<coordinator::BlobClaims::Use>(*std::move(claimed));
  const auto work = [=, this] {
    core::Status submitted =
        put_job(coordinator_.submit_job(*request, caller.name, response->mutable_warnings()), response);
    if (submitted) claim->settle();
    return submitted;
  };
  return run_unary(context, pools_.validating, caller.key, work, [&] {
    return try_later(
        *context,
        server::over_share(pools_.validating.waiting_of(caller.key), "scenes", "wait to be validated",
                           streams_.limits.waiting_scenes, "--max-waiting-scenes"),
        kTryAgainAfter);
  });
}

grpc::ServerUnaryReactor* RenderService::GetJob(grpc::CallbackServerContext* context,
                                                const v1::GetJobRequest* request,
                                                v1::GetJobResponse* response) {
  return serve(context, pools_.quick,
               [=, this](const Caller&) { return put_job(coordinator_.job(request->job_id()), response); });
}

grpc::ServerUnaryReactor* RenderService::ListJobs(grpc::CallbackServerContext* context,
                                                  const v1::ListJobsRequest* request,
                                                  v1::ListJobsResponse* response) {
  return serve(context, pools_.quick, [=, this](const Caller&) {
    for (v1::Job& job : coordinator_.jobs(*request)) *response->add_jobs() = std::move(job);
    return core::Status();
  });
}

grpc::ServerWriteReactor<v1::WatchJobResponse>* RenderService::WatchJob(grpc::CallbackServerContext* context,
                                                                        const v1::WatchJobRequest* request) {
  Caller caller;
  if (const auto admitted = auth_.admit(*context, Role::kSubmit, caller); !admitted.ok())
    return new RefusedStream<grpc::ServerWriteReactor<v1::WatchJobResponse>>(admitted);
  auto place = streams_.watches.take(caller.key);
  if (!place) {
    return new RefusedStream<grpc::ServerWriteReactor<v1::WatchJobResponse>>(
        try_later(*context,
                  server::over_share(streams_.watches.held_by(caller.key), "jobs", "are being watched",
                                     streams_.limits.watches, "--max-watches"),
                  kTryAgainAfter));
  }
  return new WatchCall(*context, watches_, streams_.stalls, {request->job_id(), *std::move(place)});
}

grpc::ServerWriteReactor<v1::GetImageResponse>* RenderService::GetImage(grpc::CallbackServerContext* context,
                                                                        const v1::GetImageRequest* request) {
  Caller caller;
  if (const auto admitted = auth_.admit(*context, Role::kSubmit, caller); !admitted.ok())
    return new RefusedStream<grpc::ServerWriteReactor<v1::GetImageResponse>>(admitted);
  return new ImageStream(*context, coordinator_, pools_, streams_, {*request, caller.key});
}

grpc::ServerUnaryReactor* RenderService::CancelJob(grpc::CallbackServerContext* context,
                                                   const v1::CancelJobRequest* request,
                                                   v1::CancelJobResponse* response) {
  return serve_change(context, pools_.quick, request->job_id(),
                      [=, this] { return put_job(coordinator_.cancel_job(request->job_id()), response); });
}

grpc::ServerUnaryReactor* RenderService::PauseJob(grpc::CallbackServerContext* context,
                                                  const v1::PauseJobRequest* request,
                                                  v1::PauseJobResponse* response) {
  return serve_change(context, pools_.quick, request->job_id(),
                      [=, this] { return put_job(coordinator_.pause_job(request->job_id()), response); });
}

grpc::ServerUnaryReactor* RenderService::ResumeJob(grpc::CallbackServerContext* context,
                                                   const v1::ResumeJobRequest* request,
                                                   v1::ResumeJobResponse* response) {
  return serve_change(context, pools_.quick, request->job_id(),
                      [=, this] { return put_job(coordinator_.resume_job(request->job_id()), response); });
}

grpc::ServerUnaryReactor* RenderService::ExtendJob(grpc::CallbackServerContext* context,
                                                   const v1::ExtendJobRequest* request,
                                                   v1::ExtendJobResponse* response) {
  return serve_change(context, pools_.slow, request->job_id(), [=, this] {
    return put_job(coordinator_.extend_job(request->job_id(), request->spp()), response);
  });
}

grpc::ServerUnaryReactor* RenderService::UpdateJob(grpc::CallbackServerContext* context,
                                                   const v1::UpdateJobRequest* request,
                                                   v1::UpdateJobResponse* response) {
  return serve_change(context, pools_.quick, request->job_id(),
                      [=, this] { return put_job(coordinator_.update_job(*request), response); });
}

grpc::ServerUnaryReactor* RenderService::DeleteJob(grpc::CallbackServerContext* context,
                                                   const v1::DeleteJobRequest* request,
                                                   v1::DeleteJobResponse*) {
  return serve_change(context, pools_.quick, request->job_id(),
                      [=, this] { return coordinator_.delete_job(request->job_id()); });
}

grpc::ServerUnaryReactor* RenderService::ListWorkers(grpc::CallbackServerContext* context,
                                                     const v1::ListWorkersRequest*,
                                                     v1::ListWorkersResponse* response) {
  return serve(context, pools_.quick, [=, this](const Caller&) {
    for (auto& worker : coordinator_.workers()) *response->add_workers() = std::move(worker);
    return core::Status();
  });
}

grpc::ServerUnaryReactor* RenderService::FindMissingBlobs(grpc::CallbackServerContext* context,
                                                          const v1::FindMissingBlobsRequest* request,
                                                          v1::FindMissingBlobsResponse* response) {
  return serve(context, pools_.quick, [=, this](const Caller& caller) {
    core::Status found = find_missing(caller.key, *request, *response);
    if (!found && found.error().code == core::ErrorCode::kResourceExhausted)
      static_cast<void>(try_later(*context, found.error(), kTryAgainAfter));
    return found;
  });
}

// Those that are here are claimed before they are looked at, and so still here when the others have come.
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
