// SPDX-License-Identifier: Apache-2.0
// What administrators do with workers: they look at the quarantine, lift it, and drain workers.
//
// Takes and returns the messages of the protocol, but knows nothing of RPC. Starts no threads: its owner
// calls save() regularly. Thread-safe. Errors are those of the protocol
// (proto/tessera/v1/admin_service.proto).
#pragma once

#include <optional>
#include <string>

#include "core/base/error.hpp"
#include "core/base/mutex.hpp"
#include "server/farm/farm.hpp"
#include "server/store/job_store.hpp"
#include "tessera/v1/admin_service.pb.h"

namespace tessera::fleet {

class Fleet {
 public:
  Fleet(farm::Farm& farm, store::JobStore& store) : farm_(farm), store_(store) {}

  // Recovers the quarantine and the drains of an earlier run, once, when the jobs are recovered. Damaged
  // entries are logged and skipped. Errors name the file that cannot be read.
  core::Status restore();
  // Stores what has changed of quarantine and drains since the last call. What could not be stored is tried
  // again. Blocks for the disk.
  core::Status save();

  // A page of the quarantine, the oldest entry first.
  core::Result<v1::ListQuarantineResponse> list_quarantine(const v1::ListQuarantineRequest& request = {});
  // Blocks until it is stored. The quarantine is lifted even if that fails, and stored later.
  core::Status lift(const std::string& id);
  // Blocks until it is stored. The worker is drained even if that fails, and it is stored later.
  core::Result<v1::DrainWorkerResponse> drain(const v1::DrainWorkerRequest& request);

 private:
  void restore(const store::QuarantineRow& row);
  // Drained workers of an earlier run that have not called in time have ended.
  void forget_absent() TESSERA_REQUIRES(saving_);
  core::Result<std::string> find_worker(const std::string& id_or_name);

  farm::Farm& farm_;
  store::JobStore& store_;
  core::Mutex saving_;  // changes reach the store in their order
  std::optional<scheduler::Time> forget_absent_at_ TESSERA_GUARDED_BY(saving_);
};

}  // namespace tessera::fleet
