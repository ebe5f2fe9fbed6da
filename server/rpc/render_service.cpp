#include "server/rpc/render_service.hpp"

#include "server/rpc/blob_streams.hpp"
#include "server/rpc/image_stream.hpp"
#include "server/rpc/reactors.hpp"
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

grpc::ServerReadReactor<v1::UploadBlobRequest>* RenderService::UploadBlob(grpc::CallbackServerContext*,
                                                                          v1::UploadBlobResponse* response) {
  return new UploadStream(coordinator_.blobs(), pools_.quick, response);
}

grpc::ServerUnaryReactor* RenderService::SubmitJob(grpc::CallbackServerContext* context,
                                                   const v1::SubmitJobRequest* request,
                                                   v1::SubmitJobResponse* response) {
  return run_unary(context, pools_.validating,
                   [=, this] { return put_job(coordinator_.submit_job(*request), response); });
}

grpc::ServerUnaryReactor* RenderService::GetJob(grpc::CallbackServerContext* context,
                                                const v1::GetJobRequest* request,
                                                v1::GetJobResponse* response) {
  return run_unary(context, pools_.quick,
                   [=, this] { return put_job(coordinator_.job(request->job_id()), response); });
}

grpc::ServerUnaryReactor* RenderService::ListJobs(grpc::CallbackServerContext* context,
                                                  const v1::ListJobsRequest*,
                                                  v1::ListJobsResponse* response) {
  return run_unary(context, pools_.quick, [=, this] {
    for (v1::Job& job : coordinator_.jobs()) *response->add_jobs() = std::move(job);
    return core::Status();
  });
}

grpc::ServerWriteReactor<v1::WatchJobResponse>* RenderService::WatchJob(grpc::CallbackServerContext*,
                                                                        const v1::WatchJobRequest* request) {
  return new WatchCall(watches_, request->job_id());
}

grpc::ServerWriteReactor<v1::GetImageResponse>* RenderService::GetImage(grpc::CallbackServerContext*,
                                                                        const v1::GetImageRequest* request) {
  return new ImageStream(coordinator_, pools_.slow, *request);
}

grpc::ServerUnaryReactor* RenderService::CancelJob(grpc::CallbackServerContext* context,
                                                   const v1::CancelJobRequest* request,
                                                   v1::CancelJobResponse* response) {
  return run_unary(context, pools_.quick,
                   [=, this] { return put_job(coordinator_.cancel_job(request->job_id()), response); });
}

grpc::ServerUnaryReactor* RenderService::PauseJob(grpc::CallbackServerContext* context,
                                                  const v1::PauseJobRequest* request,
                                                  v1::PauseJobResponse* response) {
  return run_unary(context, pools_.quick,
                   [=, this] { return put_job(coordinator_.pause_job(request->job_id()), response); });
}

grpc::ServerUnaryReactor* RenderService::ResumeJob(grpc::CallbackServerContext* context,
                                                   const v1::ResumeJobRequest* request,
                                                   v1::ResumeJobResponse* response) {
  return run_unary(context, pools_.quick,
                   [=, this] { return put_job(coordinator_.resume_job(request->job_id()), response); });
}

grpc::ServerUnaryReactor* RenderService::ExtendJob(grpc::CallbackServerContext* context,
                                                   const v1::ExtendJobRequest* request,
                                                   v1::ExtendJobResponse* response) {
  return run_unary(context, pools_.slow, [=, this] {
    return put_job(coordinator_.extend_job(request->job_id(), request->spp()), response);
  });
}

grpc::ServerUnaryReactor* RenderService::DeleteJob(grpc::CallbackServerContext* context,
                                                   const v1::DeleteJobRequest* request,
                                                   v1::DeleteJobResponse*) {
  return run_unary(context, pools_.quick, [=, this] { return coordinator_.delete_job(request->job_id()); });
}

grpc::ServerUnaryReactor* RenderService::ListWorkers(grpc::CallbackServerContext* context,
                                                     const v1::ListWorkersRequest*,
                                                     v1::ListWorkersResponse* response) {
  return run_unary(context, pools_.quick, [=, this] {
    for (auto& worker : coordinator_.workers()) *response->add_workers() = std::move(worker);
    return core::Status();
  });
}

grpc::ServerUnaryReactor* RenderService::FindMissingBlobs(grpc::CallbackServerContext* context,
                                                          const v1::FindMissingBlobsRequest* request,
                                                          v1::FindMissingBlobsResponse* response) {
  return run_unary(context, pools_.quick, [=, this]() -> core::Status {
    std::set<proto::Digest> missing;
    for (const v1::Digest& message : request->digests()) {
      const auto digest = proto::from_proto(message);
      if (!digest) return core::fail(digest.error());
      if (!coordinator_.blobs().contains(*digest)) missing.insert(*digest);
    }
    for (const proto::Digest& digest : missing) *response->add_missing() = proto::to_proto(digest);
    return {};
  });
}

}  // namespace tessera::rpc
