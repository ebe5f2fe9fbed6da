// SPDX-License-Identifier: Apache-2.0
#include "server/jobs/find_job.hpp"

#include <fmt/format.h>

#include <utility>

namespace tessera::jobs {

namespace {

std::optional<FoundJob> look_in_memory(farm::Farm& farm, const std::string& id) {
  const farm::StateLock lock(farm);
  return find_in_memory(lock, id);
}

}  // namespace

std::optional<FoundJob> find_in_memory(const farm::StateLock& lock, const std::string& id) {
  if (const farm::JobRecord* const record = lock->find_job(id))
    return FoundJob{lock.snapshot_of(*record), record->film};
  if (const farm::ValidatingJob* const job = lock->find_validating(id))
    return FoundJob{lock.snapshot_of(*job)};
  return std::nullopt;
}

core::Error no_job(const std::string& id) {
  return {core::ErrorCode::kNotFound, fmt::format("there is no job {}", id)};
}

core::Error is_being_validated(const std::string& id) {
  return {core::ErrorCode::kFailedPrecondition,
          fmt::format("job {} is being validated: wait until it runs, or cancel it", id)};
}

// A job that is brought back into memory meanwhile is found by the second look.
core::Result<FoundJob> find_job(farm::Farm& farm, store::JobStore& store, const std::string& id) {
  if (auto found = look_in_memory(farm, id)) return *std::move(found);
  const auto row = store.job(id);
  if (!row) return core::fail(row.error());
  if (!*row) return core::fail(no_job(id));
  if ((*row)->settled) return FoundJob{farm::snapshot_of_row(**row), {}, true};
  if (auto found = look_in_memory(farm, id)) return *std::move(found);
  return FoundJob{farm::snapshot_of_row(**row)};
}

}  // namespace tessera::jobs
