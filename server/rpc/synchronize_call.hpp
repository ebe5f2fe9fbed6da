// SPDX-License-Identifier: Apache-2.0
// One call of Synchronize, for as long as it waits.
#pragma once

#include <grpcpp/support/server_callback.h>

#include "server/coordinator/coordinator.hpp"
#include "server/coordinator/thread_pool.hpp"

namespace tessera::rpc {

// Owned by gRPC until OnDone, which comes after the one Finish; the coordinator answers exactly once.
class SynchronizeCall final : public grpc::ServerUnaryReactor {
 public:
  SynchronizeCall(grpc::CallbackServerContext& context, coordinator::Coordinator& coordinator,
                  coordinator::ThreadPool& pool, const v1::SynchronizeRequest* request,
                  v1::SynchronizeResponse* response);

 private:
  void answer(core::Result<v1::SynchronizeResponse> result);
  void OnDone() override { delete this; }

  v1::SynchronizeResponse* const response_;
};

}  // namespace tessera::rpc
