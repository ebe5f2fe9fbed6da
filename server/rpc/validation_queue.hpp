// SPDX-License-Identifier: Apache-2.0
// The scenes that wait to be validated. Callers share the queue, and take turns. Thread-safe.
#pragma once

#include <optional>
#include <string>

#include "server/base/fair_pool.hpp"
#include "server/coordinator.hpp"
#include "server/limits.hpp"

namespace tessera::rpc {

class ValidationQueue {
 public:
  // Validation can take minutes, so it has threads of its own.
  ValidationQueue(server::Coordinator& coordinator, const server::Limits& limits)
      : coordinator_(coordinator), limits_(limits), pool_(limits.validations, limits.waiting_scenes) {}

  // A place for a scene that is to be submitted. RESOURCE_EXHAUSTED, a temporary condition, if the caller's
  // share of the queue is used up.
  core::Result<base::FairShare::Held> reserve(const std::string& caller);
  // Validates the job when it is the caller's turn.
  void post(const std::string& caller, base::FairShare::Held place, const std::string& job_id);
  // Enters the jobs that nobody is going to validate, as far as there is room: those of an earlier run of the
  // coordinator, and those whose validation had no result. Call it regularly.
  void post_unvalidated();
  // The number of waiting scenes.
  std::uint64_t waiting() const { return pool_.waiting(); }
  // Waiting scenes are validated after a restart.
  void close() { pool_.close(); }

 private:
  server::Coordinator& coordinator_;
  const server::Limits& limits_;
  base::FairPool pool_;
};

}  // namespace tessera::rpc
