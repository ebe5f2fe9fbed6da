// SPDX-License-Identifier: Apache-2.0
// The users' service: each method asks who calls, hands its request to the coordinator and its answer to
// gRPC, and does nothing else. Thread-safe.
#pragma once

#include "server/coordinator/coordinator.hpp"
#include "server/rpc/auth_interceptor.hpp"
#include "server/rpc/pools.hpp"
#include "server/rpc/reactors.hpp"
#include "server/rpc/stream_limits.hpp"
#include "server/rpc/watch_hub.hpp"
#include "tessera/v1/render_service.grpc.pb.h"

namespace tessera::rpc {

class RenderService final : public v1::RenderService::CallbackService {
 public:
  RenderService(coordinator::Coordinator& coordinator, AuthInterceptor& gate, Pools pools, WatchHub& watches,
                StreamLimits& streams)
      : coordinator_(coordinator), auth_(gate), pools_(pools), watches_(watches), streams_(streams) {}

  grpc::ServerUnaryReactor* FindMissingBlobs(grpc::CallbackServerContext* context,
                                             const v1::FindMissingBlobsRequest* request,
                                             v1::FindMissingBlobsResponse* response) override;
  grpc::ServerReadReactor<v1::UploadBlobRequest>* UploadBlob(grpc::CallbackServerContext* context,
                                                             v1::UploadBlobResponse* response) override;
  grpc::ServerUnaryReactor* SubmitJob(grpc::CallbackServerContext* context,
                                      const v1::SubmitJobRequest* request,
                                      v1::SubmitJobResponse* response) override;
  grpc::ServerUnaryReactor* GetJob(grpc::CallbackServerContext* context, const v1::GetJobRequest* request,
                                   v1::GetJobResponse* response) override;
  grpc::ServerUnaryReactor* ListJobs(grpc::CallbackServerContext* context, const v1::ListJobsRequest* request,
                                     v1::ListJobsResponse* response) override;
  grpc::ServerWriteReactor<v1::WatchJobResponse>* WatchJob(grpc::CallbackServerContext* context,
                                                           const v1::WatchJobRequest* request) override;
  grpc::ServerWriteReactor<v1::GetImageResponse>* GetImage(grpc::CallbackServerContext* context,
                                                           const v1::GetImageRequest* request) override;
  grpc::ServerUnaryReactor* CancelJob(grpc::CallbackServerContext* context,
                                      const v1::CancelJobRequest* request,
                                      v1::CancelJobResponse* response) override;
  grpc::ServerUnaryReactor* PauseJob(grpc::CallbackServerContext* context, const v1::PauseJobRequest* request,
                                     v1::PauseJobResponse* response) override;
  grpc::ServerUnaryReactor* ResumeJob(grpc::CallbackServerContext* context,
                                      const v1::ResumeJobRequest* request,
                                      v1::ResumeJobResponse* response) override;
  grpc::ServerUnaryReactor* ExtendJob(grpc::CallbackServerContext* context,
                                      const v1::ExtendJobRequest* request,
                                      v1::ExtendJobResponse* response) override;
  grpc::ServerUnaryReactor* UpdateJob(grpc::CallbackServerContext* context,
                                      const v1::UpdateJobRequest* request,
                                      v1::UpdateJobResponse* response) override;
  grpc::ServerUnaryReactor* DeleteJob(grpc::CallbackServerContext* context,
                                      const v1::DeleteJobRequest* request,
                                      v1::DeleteJobResponse* response) override;
  grpc::ServerUnaryReactor* ListWorkers(grpc::CallbackServerContext* context,
                                        const v1::ListWorkersRequest* request,
                                        v1::ListWorkersResponse* response) override;

 private:
  // Answers with the status of work(caller), run on `pool`; or that of when_full(caller), where too much
  // waits for that already.
  template <typename Pool, typename Work, typename WhenFull>
  grpc::ServerUnaryReactor* serve(grpc::CallbackServerContext* context, Pool& pool, Work work,
                                  WhenFull when_full);
  template <typename Pool, typename Work>
  grpc::ServerUnaryReactor* serve(grpc::CallbackServerContext* context, Pool& pool, Work work);
  // The same with the status of work(), for callers who may change the job.
  template <typename Pool, typename Work>
  grpc::ServerUnaryReactor* serve_change(grpc::CallbackServerContext* context, Pool& pool,
                                         const std::string& job_id, Work work);
  core::Status find_missing(const std::string& caller, const v1::FindMissingBlobsRequest& request,
                            v1::FindMissingBlobsResponse& response);
  core::Status may_change(const Caller& caller, const std::string& job_id);

  coordinator::Coordinator& coordinator_;
  AuthInterceptor& auth_;
  const Pools pools_;
  WatchHub& watches_;
  StreamLimits& streams_;
};

}  // namespace tessera::rpc
