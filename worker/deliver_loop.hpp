// SPDX-License-Identifier: Apache-2.0
// Delivers results to the coordinator, and keeps each until it was accepted or rejected. Runs on one thread.
#pragma once

#include <stop_token>
#include <string>

#include "core/base/error.hpp"
#include "tessera/v1/worker_service.grpc.pb.h"
#include "worker/identity.hpp"
#include "worker/lease_tracker.hpp"
#include "worker/metrics.hpp"

namespace tessera::worker {

class DeliverLoop {
 public:
  DeliverLoop(Identity identity, v1::WorkerService::StubInterface& coordinator, LeaseTracker& lease_tracker,
              Metrics& metrics)
      : identity_(std::move(identity)),
        coordinator_(coordinator),
        lease_tracker_(lease_tracker),
        metrics_(metrics) {}

  // Returns when everything is delivered after LeaseTracker::drain(), or after a stop, which drops the rest.
  void run(const std::stop_token& stop);

 private:
  v1::SubmitResultRequest encode(const Delivery& delivery) const;
  core::Status submit(const v1::SubmitResultRequest& request, const std::stop_token& stop,
                      v1::SubmitResultResponse& response);

  const Identity identity_;
  v1::WorkerService::StubInterface& coordinator_;
  LeaseTracker& lease_tracker_;
  Metrics& metrics_;
};

}  // namespace tessera::worker
