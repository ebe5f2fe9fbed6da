// SPDX-License-Identifier: Apache-2.0
// The administrators' service: each method passes its request to the fleet and the answer to gRPC.
// Thread-safe.
#pragma once

#include "server/base/fair_pool.hpp"
#include "server/coordinator.hpp"
#include "server/rpc/guarded_service.hpp"
#include "tessera/v1/admin_service.pb.h"

namespace tessera::rpc {

class AdminService final : public GuardedService {
 public:
  AdminService(server::Coordinator& coordinator, auth::AuthInterceptor& gate, base::FairPool& pool,
               StreamLimits& streams);

 private:
  void list_quarantine(UnaryCall<v1::ListQuarantineRequest, v1::ListQuarantineResponse>& call);
  void lift_quarantine(UnaryCall<v1::LiftQuarantineRequest, v1::LiftQuarantineResponse>& call);
  void drain_worker(UnaryCall<v1::DrainWorkerRequest, v1::DrainWorkerResponse>& call);

  server::Coordinator& coordinator_;
  base::FairPool& pool_;
};

}  // namespace tessera::rpc
