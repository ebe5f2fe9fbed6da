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
#include "worker/holdings.hpp"
#include "worker/identity.hpp"

namespace tessera::worker {

class SyncLoop {
 public:
  // The error of a call that failed.
  using Explain = std::function<core::Error(const grpc::Status&)>;

  SyncLoop(
      Identity identity, v1::WorkerService::StubInterface& coordinator, Holdings& holdings,
      Explain explain = [](const grpc::Status& status) { return proto::error_from_grpc(status); })
      : identity_(std::move(identity)),
        explain_(std::move(explain)),
        coordinator_(coordinator),
        holdings_(holdings) {}

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
  const Explain explain_;
  v1::WorkerService::StubInterface& coordinator_;
  Holdings& holdings_;
  bool connected_ = false;
  std::set<std::string> told_reasons_;  // why it is not answered; empty while it is
};

}  // namespace tessera::worker
