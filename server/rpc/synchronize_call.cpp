// SPDX-License-Identifier: Apache-2.0
#include "server/rpc/synchronize_call.hpp"

#include <fmt/format.h>

#include <atomic>
#include <utility>

#include "proto/status.hpp"
#include "proto/worker_key.hpp"
#include "server/rpc/reactors.hpp"
#include "server/rpc/worker_principal.hpp"

namespace tessera::rpc {

namespace {

// A caller must prove that it has the key of the worker id.
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

void SynchronizeCall::begin() {
  if (const auto proved = check_worker_key(*request_); !proved) return Finish(proto::to_grpc(proved));
  {
    const core::MutexLock lock(mutex_);
    worker_ = request_->worker_id();
  }
  if (!pool_.run_or_post([this] { synchronize(); })) Finish(busy());
}

// A call that has not begun finds out by itself. If too much waits, or memory is out, the call ends when it
// is due. The task may run after gRPC has deleted the call.
void SynchronizeCall::on_cancel() {
  static_cast<void>(guarded([this]() -> core::Status {
    const core::MutexLock lock(mutex_);
    const auto remove = [&coordinator = coordinator_, worker = worker_] {
      coordinator.dispatcher().remove_gone(worker);
    };
    if (!worker_.empty()) static_cast<void>(pool_.post(remove));
    return {};
  }));
}

// The answer may arrive, and delete this object, before the coordinator returns. If the coordinator throws,
// an answer may still arrive: only the first one counts.
void SynchronizeCall::synchronize() {
  const std::unique_ptr<const v1::SynchronizeRequest> request = std::move(request_);
  const auto answered = std::make_shared<std::atomic_flag>();
  const auto give_once = [this, answered](core::Result<v1::SynchronizeResponse> result) {
    if (!answered->test_and_set()) give(std::move(result));
  };
  const core::Status done = guarded([&]() -> core::Status {
    const auto is_gone = [this, answered] { return answered->test() || context().IsCancelled(); };
    coordinator_.dispatcher().synchronize(
        *request, {.answer = give_once, .is_gone = is_gone, .principal = principal_of(caller())});
    return {};
  });
  if (!done) give_once(core::fail(done.error()));
}

void SynchronizeCall::give(core::Result<v1::SynchronizeResponse> result) {
  result ? answer(*result) : Finish(proto::to_grpc(result.error()));
}

}  // namespace tessera::rpc
