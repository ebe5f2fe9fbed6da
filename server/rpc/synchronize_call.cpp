#include "server/rpc/synchronize_call.hpp"

#include <utility>

#include "proto/status.hpp"
#include "server/rpc/reactors.hpp"

namespace tessera::rpc {

SynchronizeCall::SynchronizeCall(coordinator::Coordinator& coordinator, coordinator::ThreadPool& pool,
                                 const v1::SynchronizeRequest* request, v1::SynchronizeResponse* response)
    : response_(response) {
  const bool posted = pool.post([this, &coordinator, request] {
    coordinator.synchronize(
        *request, [this](core::Result<v1::SynchronizeResponse> result) { answer(std::move(result)); });
  });
  if (!posted) Finish(busy());
}

void SynchronizeCall::answer(core::Result<v1::SynchronizeResponse> result) {
  if (!result) return Finish(proto::to_grpc(result.error()));
  *response_ = std::move(*result);
  Finish(grpc::Status::OK);
}

}  // namespace tessera::rpc
