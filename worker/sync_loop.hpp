// SPDX-License-Identifier: Apache-2.0
// The conversation with the coordinator: says what is held, takes over what should be, for as long as the
// worker runs. Level-triggered: a lost answer or a restarted coordinator needs no special care. One thread
// runs it.
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

namespace tessera::worker {

class SyncLoop {
 public:
  // The error of a call that failed.
  using Explain = std::function<core::Error(const grpc::Status&)>;

  // After a refusal, which lasts until somebody changes something.
  static constexpr proto::BackoffOptions kRefusalBackoff{.first = std::chrono::seconds(2),
                                                         .longest = std::chrono::seconds(60)};

  SyncLoop(
      Identity identity, v1::WorkerService::StubInterface& coordinator, LeaseTracker& lease_tracker,
      Explain explain = [](const grpc::Status& status) { return proto::error_from_grpc(status); },
      proto::BackoffOptions refusal_backoff = kRefusalBackoff)
      : identity_(std::move(identity)),
        explain_(std::move(explain)),
        refusal_backoff_(refusal_backoff),
        coordinator_(coordinator),
        lease_tracker_(lease_tracker) {}

  // Returns after a stop, or with PERMISSION_DENIED if the coordinator does not accept this worker's
  // credentials the first time. Whatever else goes wrong is tried again, forever; where the coordinator
  // refuses this worker for what it is, with pauses of up to a minute.
  core::Status run(const std::stop_token& stop);

  // Tells the coordinator that this worker leaves. Blocks a few seconds at most; nobody depends on its
  // success.
  void deregister();

 private:
  core::Result<v1::SynchronizeResponse> synchronize(const std::stop_token& stop, proto::Duration deadline);
  bool is_final(core::ErrorCode code) const;
  void note_success();
  void note_failure(const core::Error& error);

  const Identity identity_;
  const Explain explain_;
  const proto::BackoffOptions refusal_backoff_;
  v1::WorkerService::StubInterface& coordinator_;
  LeaseTracker& lease_tracker_;
  bool connected_ = false;
  std::set<std::string> told_reasons_;  // why it is not answered; empty while it is
};

}  // namespace tessera::worker
