// SPDX-License-Identifier: Apache-2.0
// Runs done jobs again, for more samples or to verify some of theirs. Their films are only in the store, and
// are read back without the state lock.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <optional>
#include <set>
#include <utility>

#include "proto/convert.hpp"
#include "server/jobs/admission.hpp"
#include "server/jobs/continuation.hpp"
#include "server/jobs/job_service.hpp"
#include "server/jobs/quota.hpp"

namespace tessera::jobs {

using core::ErrorCode;
using farm::JobRecord;
using farm::JobSnapshot;
using farm::StateLock;

namespace {

// Whether the film must be read back before the job can take results.
bool needs_film(const StateLock& lock, const JobRecord& record) {
  return !record.film &&
         scheduler::takes_results(lock->scheduler.job({record.spec->id()}, lock.now())->state);
}

core::Status may_extend(const StateLock& lock, const JobRecord& record, std::uint32_t spp,
                        const server::Limits& limits) {
  v1::RenderSettings settings = record.spec->settings();
  settings.set_spp(spp);
  if (const auto possible = proto::from_proto(settings); !possible) return core::fail(possible.error());
  if (const auto fits = check_spp(spp, limits); !fits) return fits;
  const scheduler::JobView view = *lock->scheduler.job({record.spec->id()}, lock.now());
  if (view.state == scheduler::JobState::kDone && spp > view.shape.spp)
    if (const auto may = may_open_job(lock, record.spec->submitter(), limits); !may) return may;
  return may_continue(record, lock.options().fingerprint);
}

}  // namespace

// The revision of a job that the film belongs to, and the film if it had to be read.
struct JobService::Extension {
  std::uint64_t revision = 0;
  std::shared_ptr<film::JobFilm> film;
};

core::Result<JobService::Extension> JobService::prepare_extension(const std::string& id,
                                                                  std::optional<std::uint32_t> spp) {
  Extension extension;
  std::shared_ptr<const v1::Job> job;
  {
    const StateLock lock(farm_);
    const JobRecord* record = lock->find_job(id);
    if (record == nullptr) return core::fail(ErrorCode::kNotFound, fmt::format("there is no job {}", id));
    extension.revision = record->revision;
    if (spp) {
      if (auto may = may_extend(lock, *record, *spp, limits_); !may) return core::fail(may.error());
    }
    if (!needs_film(lock, *record)) return extension;
    job = record->spec;
  }
  if (spp) {
    if (auto room = check_film_memory(farm::grid_of(*job), film_memory_); !room)
      return core::fail(room.error());
  }
  auto loaded = films_.load(*job);
  if (!loaded) return core::fail(loaded.error());
  if (!loaded->damage.empty()) {
    return core::fail(ErrorCode::kDataLoss, loaded->damage.front() + ": delete the job and submit it again");
  }
  extension.film = std::move(loaded->film);
  return extension;
}

core::Result<v1::Job> JobService::extend(const std::string& id, std::uint32_t spp) {
  while (true) {
    auto extension = prepare_extension(id, spp);
    if (!extension) return core::fail(extension.error());
    const auto changed = [&]() -> std::optional<core::Result<JobSnapshot>> {
      StateLock lock(farm_);
      JobRecord* record = lock->find_job(id);
      if (record == nullptr || record->revision != extension->revision) return std::nullopt;  // changed
      if (needs_film(lock, *record) && !extension->film) return std::nullopt;                 // stored
      if (auto may = may_extend(lock, *record, spp, limits_); !may) return core::fail(may.error());
      if (!record->film) record->film = std::move(extension->film);
      if (const auto done = lock.handle(scheduler::ExtendJob{{id}, spp}).status; !done)
        return core::fail(done.error());
      ++record->revision;
      return lock.snapshot_of(*record);
    }();
    if (changed) return store_change(*changed);
  }
}

void JobService::reopen() {
  std::set<std::string> ids;
  StateLock(farm_)->to_reopen.swap(ids);
  for (const std::string& id : ids) {
    const core::Status reopened = reopen(id);
    if (reopened || reopened.error().code == core::ErrorCode::kNotFound) continue;
    spdlog::error("job {} was rendered in part by a worker that is quarantined, and cannot be verified: {}",
                  id, reopened.error().message);
  }
}

core::Status JobService::reopen(const std::string& id) {
  while (true) {
    auto preparation = prepare_extension(id, std::nullopt);
    if (!preparation) return core::fail(preparation.error());
    StateLock lock(farm_);
    JobRecord* record = lock->find_job(id);
    if (record == nullptr || record->revision != preparation->revision) continue;  // changed meanwhile
    if (needs_film(lock, *record) && !preparation->film) continue;                 // stored meanwhile
    if (auto may = may_continue(*record, lock.options().fingerprint); !may) return may;
    if (!record->film) record->film = std::move(preparation->film);
    return lock.handle(scheduler::ReopenJob{{id}}).status;
  }
}

}  // namespace tessera::jobs
