// SPDX-License-Identifier: Apache-2.0
// The users' service: each method passes its request to the coordinator and the answer to gRPC. Thread-safe.
#pragma once

#include <string>

#include "server/coordinator.hpp"
#include "server/rpc/guarded_service.hpp"
#include "server/rpc/pools.hpp"
#include "server/rpc/server_info.hpp"
#include "server/rpc/stream_limits.hpp"
#include "server/rpc/validation_queue.hpp"
#include "server/rpc/watch_hub.hpp"
#include "tessera/v1/render_service.pb.h"

namespace tessera::rpc {

class RenderService final : public GuardedService {
 public:
  RenderService(server::Coordinator& coordinator, auth::AuthInterceptor& gate, Pools pools,
                ValidationQueue& validations, WatchHub& watches, StreamLimits& streams, ServerFacts facts);

 private:
  template <typename Request, typename Response>
  using Call = UnaryCall<Request, Response>;

  void find_missing_blobs(Call<v1::FindMissingBlobsRequest, v1::FindMissingBlobsResponse>& call);
  void upload_batch(Call<v1::BatchUploadBlobsRequest, v1::BatchUploadBlobsResponse>& call);
  void get_upload(Call<v1::GetUploadRequest, v1::GetUploadResponse>& call);
  void submit_job(Call<v1::SubmitJobRequest, v1::SubmitJobResponse>& call);
  void get_job(Call<v1::GetJobRequest, v1::GetJobResponse>& call);
  void list_jobs(Call<v1::ListJobsRequest, v1::ListJobsResponse>& call);
  void cancel_job(Call<v1::CancelJobRequest, v1::CancelJobResponse>& call);
  void pause_job(Call<v1::PauseJobRequest, v1::PauseJobResponse>& call);
  void resume_job(Call<v1::ResumeJobRequest, v1::ResumeJobResponse>& call);
  void extend_job(Call<v1::ExtendJobRequest, v1::ExtendJobResponse>& call);
  void update_job(Call<v1::UpdateJobRequest, v1::UpdateJobResponse>& call);
  void delete_job(Call<v1::DeleteJobRequest, v1::DeleteJobResponse>& call);
  void list_workers(Call<v1::ListWorkersRequest, v1::ListWorkersResponse>& call);
  void get_server_info(Call<v1::GetServerInfoRequest, v1::GetServerInfoResponse>& call);

  // Registers a method, served by a class that is derived from WatchStream.
  template <typename AnyWatch>
  void add_watch(const std::string& method);
  // Answers with the status of work(), run on `pool`, if the caller may change the job.
  template <typename AnyCall, typename Pool, typename Work>
  void run_change(AnyCall& call, Pool& pool, Work work);

  server::Coordinator& coordinator_;
  const Pools pools_;
  ValidationQueue& validations_;
  WatchHub& watches_;
  StreamLimits& streams_;
  const ServerFacts facts_;
};

}  // namespace tessera::rpc
