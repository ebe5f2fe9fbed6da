// Brings what is rendered to the coordinator, and keeps it until it has arrived or was refused. One thread
// runs it.
#pragma once

#include <stop_token>
#include <string>

#include "core/base/error.hpp"
#include "tessera/v1/worker_service.grpc.pb.h"
#include "worker/holdings.hpp"
#include "worker/identity.hpp"

namespace tessera::worker {

class DeliverLoop {
 public:
  DeliverLoop(Identity identity, v1::WorkerService::StubInterface& coordinator, Holdings& holdings)
      : identity_(std::move(identity)), coordinator_(coordinator), holdings_(holdings) {}

  // Returns when all is delivered after Holdings::drain(), or after a stop, which gives up what is left.
  void run(const std::stop_token& stop);

 private:
  v1::SubmitResultRequest encode(const Delivery& delivery) const;
  core::Status submit(const v1::SubmitResultRequest& request, const std::stop_token& stop,
                      v1::SubmitResultResponse& response);

  const Identity identity_;
  v1::WorkerService::StubInterface& coordinator_;
  Holdings& holdings_;
};

}  // namespace tessera::worker
