// SPDX-License-Identifier: Apache-2.0
// Runs done jobs again in which unverified samples of quarantined workers are. Most of them are in the store
// alone: the producers in their rows tell which.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <set>
#include <thread>
#include <utility>

#include "core/common/log.hpp"
#include "server/film/producer_keys.hpp"
#include "server/jobs/continuation.hpp"
#include "server/jobs/find_job.hpp"
#include "server/jobs/job_service.hpp"

namespace tessera::jobs {

using farm::StateLock;
using scheduler::JobState;

void JobService::reopen() {
  std::vector<scheduler::Producer> producers;
  StateLock(farm_)->to_search.swap(producers);
  if (!producers.empty()) {
    if (const auto found = find_jobs_to_reopen(producers); !found) {
      spdlog::error("cannot find the jobs with samples of quarantined workers, and will try again: {}",
                    found.error().message);
      StateLock lock(farm_);
      lock->to_search.insert(lock->to_search.end(), producers.begin(), producers.end());
    }
  }
  std::set<std::string> ids;
  StateLock(farm_)->to_reopen.swap(ids);
  for (const std::string& id : ids) {
    auto reopened = reopen_in_memory(id);
    while (!reopened) {
      reopened = reopen_stored(id);
      if (!reopened) reopened = reopen_in_memory(id);
      if (!reopened) std::this_thread::yield();
    }
    if (*reopened || reopened->error().code == core::ErrorCode::kNotFound) continue;
    common::log(spdlog::level::err,
                fmt::format("job {} was rendered in part by a worker that is quarantined, and cannot be "
                            "verified: {}",
                            id, reopened->error().message),
                {.job = id});
  }
}

core::Status JobService::find_jobs_to_reopen(const std::vector<scheduler::Producer>& producers) {
  std::set<std::string> found;
  const auto read = state_.jobs.for_each_job([&](const store::JobRow& row) {
    if (!row.settled || row.state != v1::JOB_STATE_DONE || stopping_.stop_requested()) return;
    const film::ProducerKeys keys(row.producers);
    const auto is_in_it = [&](const scheduler::Producer& producer) { return keys.contains(producer); };
    if (std::any_of(producers.begin(), producers.end(), is_in_it)) found.insert(row.id);
  });
  StateLock(farm_)->to_reopen.merge(found);
  return read;
}

std::optional<core::Status> JobService::reopen_in_memory(const std::string& id) {
  StateLock lock(farm_);
  const farm::JobRecord* const record = lock->find_job(id);
  if (record == nullptr) return std::nullopt;
  if (auto may = may_continue(*record, lock.options().fingerprints); !may) return may;
  return lock.handle(scheduler::ReopenJob{{id}}).status;
}

std::optional<core::Status> JobService::reopen_stored(const std::string& id) {
  auto row = state_.jobs.job(id);
  if (!row) return core::fail(row.error());
  if (!*row) return core::fail(no_job(id));
  if (!(*row)->settled) return std::nullopt;
  if ((*row)->state != v1::JOB_STATE_DONE) return core::Status();
  const auto record = farm::from_row(**row);
  if (!record) return core::fail(record.error());
  if (auto may = may_continue(*record, farm_.options().fingerprints); !may) return may;
  const scheduler::JobShape shape = farm::shape_of(*record->spec, **row);
  const auto is_back = bring_back(**std::move(row), JobState::kDone, shape);
  if (!is_back) return core::fail(is_back.error());
  if (!*is_back) return std::nullopt;
  return core::Status();
}

}  // namespace tessera::jobs
