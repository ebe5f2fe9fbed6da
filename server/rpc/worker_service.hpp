// SPDX-License-Identifier: Apache-2.0
// The workers' service: each method asks who calls, hands its request to the coordinator and its answer to
// gRPC, and does nothing else. Thread-safe.
#pragma once

#include "server/coordinator/coordinator.hpp"
#include "server/coordinator/thread_pool.hpp"
#include "server/rpc/auth_interceptor.hpp"
#include "server/rpc/stream_limits.hpp"
#include "tessera/v1/worker_service.grpc.pb.h"

namespace tessera::rpc {

class WorkerService final : public v1::WorkerService::CallbackService {
 public:
  WorkerService(coordinator::Coordinator& coordinator, AuthInterceptor& gate, coordinator::ThreadPool& pool,
                StreamLimits& streams)
      : coordinator_(coordinator), auth_(gate), pool_(pool), streams_(streams) {}

  grpc::ServerUnaryReactor* Synchronize(grpc::CallbackServerContext* context,
                                        const v1::SynchronizeRequest* request,
                                        v1::SynchronizeResponse* response) override;
  grpc::ServerUnaryReactor* SubmitResult(grpc::CallbackServerContext* context,
                                         const v1::SubmitResultRequest* request,
                                         v1::SubmitResultResponse* response) override;
  grpc::ServerWriteReactor<v1::FetchBlobResponse>* FetchBlob(grpc::CallbackServerContext* context,
                                                             const v1::FetchBlobRequest* request) override;

 private:
  coordinator::Coordinator& coordinator_;
  AuthInterceptor& auth_;
  coordinator::ThreadPool& pool_;
  StreamLimits& streams_;
};

}  // namespace tessera::rpc
