// SPDX-License-Identifier: Apache-2.0
// Synchronises with the coordinator: reports the leases that are held and applies the answers, as long as the
// worker runs. Each call carries the full state, so a lost answer or a restarted coordinator needs no special
// handling. Runs on one thread.
#pragma once

#include <functional>
#include <set>
#include <stop_token>
#include <string>

#include "core/base/error.hpp"
#include "proto/retry.hpp"
#include "proto/status.hpp"
#include "tessera/v1/worker_service.grpc.pb.h"
#include "worker/identity.hpp"
#include "worker/lease_tracker.hpp"
#include "worker/metrics.hpp"

namespace tessera::worker {

class SyncLoop {
 public:
  // Adds to a request what the loop does not know itself. Called on its thread.
  using Complete = std::function<void(v1::SynchronizeRequest& request)>;
  // Makes the error of a failed call.
  using Explain = std::function<core::Error(const grpc::Status&)>;

  // After a rejection, which lasts until an operator changes something.
  static constexpr proto::BackoffOptions kRefusalBackoff{.first = std::chrono::seconds(2),
                                                         .longest = std::chrono::seconds(60)};

  SyncLoop(
      Identity identity, v1::WorkerService::StubInterface& coordinator, LeaseTracker& lease_tracker,
      Metrics& metrics,
      Explain explain = [](const grpc::Status& status) { return proto::error_from_grpc(status); },
      proto::BackoffOptions refusal_backoff = kRefusalBackoff, Complete complete = [](auto&) {})
      : identity_(std::move(identity)),
        explain_(std::move(explain)),
        refusal_backoff_(refusal_backoff),
        complete_(std::move(complete)),
        coordinator_(coordinator),
        lease_tracker_(lease_tracker),
        metrics_(metrics) {}

  // Returns after a stop, or when the coordinator tells the worker to stop; whether it did. Retries after all
  // errors, for ever: if the coordinator rejects the worker or its credentials, with pauses that grow to a
  // minute.
  bool run(const std::stop_token& stop);

  // Deregisters this worker from the coordinator. Blocks a few seconds at most; nothing depends on its
  // success.
  void deregister();

 private:
  core::Result<v1::SynchronizeResponse> synchronize(const std::stop_token& stop, proto::Duration deadline);
  void note_success();
  void note_failure(const core::Error& error);

  const Identity identity_;
  const Explain explain_;
  const proto::BackoffOptions refusal_backoff_;
  const Complete complete_;
  v1::WorkerService::StubInterface& coordinator_;
  LeaseTracker& lease_tracker_;
  Metrics& metrics_;
  bool connected_ = false;
  std::set<std::string> told_reasons_;  // the reasons logged since the last success
};

}  // namespace tessera::worker
