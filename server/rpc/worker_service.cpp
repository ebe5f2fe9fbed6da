// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/worker_service.hpp"

#include <utility>

#include "server/rpc/blob_streams.hpp"
#include "server/rpc/reactors.hpp"
#include "server/rpc/synchronize_call.hpp"
#include "server/rpc/worker_principal.hpp"

namespace tessera::rpc {

namespace {

// The approximate maximum of a result of one tile, which is decompressed in less than a millisecond.
constexpr std::size_t kShortResultBytes = 256 << 10;

}  // namespace

WorkerService::WorkerService(server::Coordinator& coordinator, auth::AuthInterceptor& gate,
                             const Pools& pools, StreamLimits& streams)
    : GuardedService("tessera.v1.WorkerService", gate, streams),
      coordinator_(coordinator),
      pools_(pools),
      calls_(streams.calls) {
  add_unary("SubmitResult", &WorkerService::submit_result);
  add_call("Synchronize", [this, &streams](grpc::CallbackServerContext& context, auth::Admission admission) {
    return new SynchronizeCall(context, coordinator_, pools_.heartbeats, streams, std::move(admission));
  });
  add_call("FetchBlob", [this, &streams](grpc::CallbackServerContext& context, auth::Admission admission) {
    return new FetchStream(context, coordinator_, pools_.sending, streams, std::move(admission));
  });
}

void WorkerService::submit_result(UnaryCall<v1::SubmitResultRequest, v1::SubmitResultResponse>& call) {
  const auto count = [this, &call]() -> core::Status {
    auto counted = coordinator_.dispatcher().submit_result(call.request(), principal_of(call.caller()));
    if (!counted) return core::fail(counted.error());
    call.response() = *counted;
    return {};
  };
  const std::size_t bytes = call.request().ByteSizeLong();
  calls_.traffic.results_received += bytes;
  const bool is_short = call.request().items_size() <= 1 && bytes <= kShortResultBytes;
  is_short ? run_short_unary(call, pools_.results, count) : run_unary(call, pools_.results, count);
}

}  // namespace tessera::rpc
