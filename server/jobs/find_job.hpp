// SPDX-License-Identifier: Apache-2.0
// Finds jobs where they are: those to be validated and those in progress in memory, and finished ones in the
// store. Thread-safe; blocks for the disk.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/base/error.hpp"
#include "server/farm/farm.hpp"
#include "server/farm/state_lock.hpp"
#include "server/store/job_store.hpp"

namespace tessera::jobs {

struct FoundJob {
  farm::JobSnapshot snapshot;
  // Null if the store alone has it, or if the job has none.
  std::shared_ptr<film::JobFilm> film{};
  // The store alone has the job.
  bool is_settled = false;
};

// NOT_FOUND if there is none.
core::Result<FoundJob> find_job(farm::Farm& farm, store::JobStore& store, const std::string& id);
// Empty if it is not in memory.
std::optional<FoundJob> find_in_memory(const farm::StateLock& lock, const std::string& id);

core::Error no_job(const std::string& id);
// FAILED_PRECONDITION, for what must wait for the validation.
core::Error is_being_validated(const std::string& id);

}  // namespace tessera::jobs
