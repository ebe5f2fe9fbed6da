// SPDX-License-Identifier: Apache-2.0
// The workers' service: each method passes its request to the coordinator and the answer to gRPC.
// Thread-safe.
#pragma once

#include "server/coordinator.hpp"
#include "server/rpc/guarded_service.hpp"
#include "server/rpc/pools.hpp"
#include "server/rpc/stream_limits.hpp"
#include "tessera/v1/worker_service.pb.h"

namespace tessera::rpc {

class WorkerService final : public GuardedService {
 public:
  WorkerService(server::Coordinator& coordinator, auth::AuthInterceptor& gate, const Pools& pools,
                StreamLimits& streams);

 private:
  void submit_result(UnaryCall<v1::SubmitResultRequest, v1::SubmitResultResponse>& call);

  server::Coordinator& coordinator_;
  const Pools pools_;
  CallStats& calls_;
};

}  // namespace tessera::rpc
