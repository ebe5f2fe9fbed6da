// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/synchronize_call.hpp"

#include <utility>

#include "proto/status.hpp"
#include "server/rpc/reactors.hpp"

namespace tessera::rpc {

SynchronizeCall::SynchronizeCall(grpc::CallbackServerContext& context, coordinator::Coordinator& coordinator,
                                 coordinator::ThreadPool& pool, const v1::SynchronizeRequest* request,
                                 v1::SynchronizeResponse* response)
    : response_(response) {
  const bool posted = pool.run_or_post([this, &context, &coordinator, request] {
    coordinator::SynchronizeCaller caller;
    caller.answer = [this](core::Result<v1::SynchronizeResponse> result) { answer(std::move(result)); };
    caller.is_gone = [&context] { return context.IsCancelled(); };
    coordinator.synchronize(*request, std::move(caller));
  });
  if (!posted) Finish(busy());
}

void SynchronizeCall::answer(core::Result<v1::SynchronizeResponse> result) {
  if (!result) return Finish(proto::to_grpc(result.error()));
  *response_ = std::move(*result);
  Finish(grpc::Status::OK);
}

}  // namespace tessera::rpc
