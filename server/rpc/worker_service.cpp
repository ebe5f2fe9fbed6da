// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/worker_service.hpp"

#include <fmt/format.h>

#include <chrono>
#include <string>
#include <utility>

#include "proto/status.hpp"
#include "proto/worker_key.hpp"
#include "server/rpc/auth_interceptor.hpp"
#include "server/rpc/blob_streams.hpp"
#include "server/rpc/connection_slots.hpp"
#include "server/rpc/reactors.hpp"
#include "server/rpc/synchronize_call.hpp"

namespace tessera::rpc {

namespace {

// What a result of one tile has at most, about; it is decompressed in less than a millisecond.
constexpr std::size_t kShortResultBytes = 256 << 10;

// Nobody calls in the name of a worker whose key it does not know.
core::Status check_worker_key(const v1::SynchronizeRequest& request) {
  if (request.worker_key().size() == proto::kWorkerKeyBytes &&
      request.worker_id() == proto::worker_id_of(request.worker_key()))
    return {};
  return core::fail(
      core::ErrorCode::kFailedPrecondition,
      fmt::format("worker_key: {}",
                  request.worker_key().empty()
                      ? "is missing, as in workers of earlier releases: install the coordinator's "
                        "release on this machine"
                      : "is not that of worker_id"));
}

}  // namespace

grpc::ServerUnaryReactor* WorkerService::Synchronize(grpc::CallbackServerContext* context,
                                                     const v1::SynchronizeRequest* request,
                                                     v1::SynchronizeResponse* response) {
  Caller caller;
  if (const auto admitted = auth_.admit(*context, Role::kWork, caller); !admitted.ok())
    return refuse(context, admitted);
  if (const auto proved = check_worker_key(*request); !proved)
    return refuse(context, proto::to_grpc(proved.error()));
  return new SynchronizeCall(*context, coordinator_, pool_, request, response);
}

grpc::ServerUnaryReactor* WorkerService::SubmitResult(grpc::CallbackServerContext* context,
                                                      const v1::SubmitResultRequest* request,
                                                      v1::SubmitResultResponse* response) {
  Caller caller;
  if (const auto admitted = auth_.admit(*context, Role::kWork, caller); !admitted.ok())
    return refuse(context, admitted);
  const auto count = [=, this]() -> core::Status {
    auto counted = coordinator_.submit_result(*request);
    if (!counted) return core::fail(counted.error());
    *response = *counted;
    return {};
  };
  const bool is_short = request->items_size() <= 1 && request->ByteSizeLong() <= kShortResultBytes;
  return is_short ? run_short_unary(context, pool_, count) : run_unary(context, pool_, caller.key, count);
}

grpc::ServerWriteReactor<v1::FetchBlobResponse>* WorkerService::FetchBlob(
    grpc::CallbackServerContext* context, const v1::FetchBlobRequest* request) {
  Caller caller;
  if (const auto admitted = auth_.admit(*context, Role::kWork, caller); !admitted.ok())
    return new RefusedStream<grpc::ServerWriteReactor<v1::FetchBlobResponse>>(admitted);
  // Workers of one machine count together: each could have many connections.
  const std::string machine = client_key(context->peer());
  auto place = streams_.fetches.take(machine);
  if (!place) {
    return new RefusedStream<grpc::ServerWriteReactor<v1::FetchBlobResponse>>(
        try_later(*context,
                  server::over_share(streams_.fetches.held_by(machine), "files", "are being fetched",
                                     streams_.limits.fetches, "--max-fetches"),
                  kTryAgainAfter));
  }
  return new FetchStream(*context, coordinator_, pool_, streams_, {request->digest(), *std::move(place)});
}

}  // namespace tessera::rpc
