// The conversation with the coordinator: says what is held, takes over what should be, for as long as the
// worker runs. Level-triggered: a lost answer or a restarted coordinator needs no special care. One thread
// runs it.
#pragma once

#include <optional>
#include <stop_token>
#include <string>

#include "core/base/error.hpp"
#include "proto/retry.hpp"
#include "tessera/v1/worker_service.grpc.pb.h"
#include "worker/holdings.hpp"
#include "worker/identity.hpp"

namespace tessera::worker {

class SyncLoop {
 public:
  SyncLoop(Identity identity, v1::WorkerService::StubInterface& coordinator, Holdings& holdings)
      : identity_(std::move(identity)), coordinator_(coordinator), holdings_(holdings) {}

  // Returns after a stop, or with FAILED_PRECONDITION if the coordinator refuses this worker. Whatever else
  // goes wrong is tried again, forever.
  core::Status run(const std::stop_token& stop);

  // Tells the coordinator that this worker leaves. Blocks a few seconds at most; nobody depends on its
  // success.
  void say_goodbye();

 private:
  core::Result<v1::SynchronizeResponse> synchronize(const std::stop_token& stop, proto::Duration deadline);
  bool is_final(core::ErrorCode code) const;
  void note_success();
  void note_failure(const core::Error& error);

  const Identity identity_;
  v1::WorkerService::StubInterface& coordinator_;
  Holdings& holdings_;
  bool connected_ = false;
  std::optional<core::ErrorCode> failing_with_;  // of the last call; nothing if it was answered
};

}  // namespace tessera::worker
