// SPDX-License-Identifier: Apache-2.0
// A scripted worker: takes leases and reports them, but renders nothing.
#pragma once

#include <memory>
#include <string>

#include "tessera/v1/worker_service.grpc.pb.h"

namespace tessera::test {

class RawWorker {
 public:
  RawWorker(const std::string& address, const std::string& name);

  // The job whose files it reports to fetch from now on; empty: none.
  void say_fetching(const std::string& job_id);

  // Blocks until the coordinator answers. It holds the leases of the answer from then on.
  v1::SynchronizeResponse synchronize();

 private:
  std::unique_ptr<v1::WorkerService::StubInterface> coordinator_;
  v1::SynchronizeRequest request_;
};

}  // namespace tessera::test
