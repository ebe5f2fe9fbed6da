// SPDX-License-Identifier: Apache-2.0
// What a worker says, from a test: takes leases, says that it holds them, and renders nothing.
#pragma once

#include <memory>
#include <string>

#include "tessera/v1/worker_service.grpc.pb.h"

namespace tessera::test {

class RawWorker {
 public:
  RawWorker(const std::string& address, const std::string& name);

  // What it says it is doing from now on: the job whose files it is fetching, or none.
  void say_fetching(const std::string& job_id);

  // Blocks until the coordinator answers. What it answers is held from then on.
  v1::SynchronizeResponse synchronize();

 private:
  std::unique_ptr<v1::WorkerService::StubInterface> coordinator_;
  v1::SynchronizeRequest request_;
};

}  // namespace tessera::test
