// SPDX-License-Identifier: Apache-2.0
// Runs done jobs again, for more samples or to verify some of theirs. Their films are only in the store, and
// are read back without the state lock.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "proto/convert.hpp"
#include "server/coordinator/admission.hpp"
#include "server/coordinator/loaded_film.hpp"
#include "server/coordinator/state_lock.hpp"

namespace tessera::coordinator {

using core::ErrorCode;

// The state of a job that the film belongs to, and the film if it had to be read.
struct Coordinator::Extension {
  std::uint64_t revision = 0;
  std::unique_ptr<JobFilm> film;
};

core::Result<Coordinator::Extension> Coordinator::prepare_extension(const std::string& id) {
  Extension extension;
  std::shared_ptr<const v1::Job> spec;
  {
    const StateLock lock(*this);
    const JobRecord* record = find(id);
    if (record == nullptr) return core::fail(ErrorCode::kNotFound, fmt::format("there is no job {}", id));
    extension.revision = record->revision;
    if (!needs_film(lock, *record)) return extension;
    spec = record->spec;
  }
  auto loaded = load_film(*spec);
  if (!loaded) return core::fail(loaded.error());
  if (!loaded->damage.empty()) {
    return core::fail(ErrorCode::kDataLoss, loaded->damage.front() + ": delete the job and submit it again");
  }
  extension.film = std::move(loaded->film);
  return extension;
}

bool Coordinator::needs_film(const StateLock& lock, const JobRecord& record) const {
  return !record.film && scheduler::takes_results(scheduler_.job({record.spec->id()}, lock.now())->state);
}

core::Status Coordinator::may_extend(const StateLock& lock, const JobRecord& record,
                                     std::uint32_t spp) const {
  v1::RenderSettings settings = record.spec->settings();
  settings.set_spp(spp);
  if (const auto possible = proto::from_proto(settings); !possible) return core::fail(possible.error());
  if (const auto fits = check_spp(spp, options_.limits); !fits) return fits;
  const scheduler::JobView view = *scheduler_.job({record.spec->id()}, lock.now());
  if (view.state == scheduler::JobState::kDone && spp > view.shape.spp)
    if (const auto may = may_open_job(lock, record.spec->submitter()); !may) return may;
  return may_continue(record);
}

core::Status Coordinator::may_continue(const JobRecord& record) const {
  if (record.arithmetic.empty() || record.arithmetic == options_.fingerprint) return {};
  return core::fail(
      ErrorCode::kFailedPrecondition,
      fmt::format(
          "job {} was rendered by workers of another build (fingerprint {}; this farm's is {}), and "
          "its image cannot be continued by these: submit the scene again, or start the coordinator with "
          "--accept-fingerprint {} and workers of that build",
          record.spec->id(), record.arithmetic, options_.fingerprint, record.arithmetic));
}

core::Result<v1::Job> Coordinator::extend_job(const std::string& id, std::uint32_t spp) {
  while (true) {
    auto extension = prepare_extension(id);
    if (!extension) return core::fail(extension.error());
    std::optional<core::Result<ChangedJob>> changed;
    {
      StateLock lock(*this);
      JobRecord* record = find(id);
      if (record == nullptr || record->revision != extension->revision) continue;  // changed meanwhile
      if (needs_film(lock, *record) && !extension->film) continue;                 // stored meanwhile
      if (auto may = may_extend(lock, *record, spp); !may) return core::fail(may.error());
      if (!record->film) record->film = std::move(extension->film);
      changed = change(lock, id, scheduler::ExtendJob{{id}, spp});
    }
    return store_change(std::move(*changed));
  }
}

void Coordinator::reopen_jobs() {
  std::set<std::string> ids;
  {
    const StateLock lock(*this);
    ids.swap(to_reopen_);
  }
  for (const std::string& id : ids) {
    const core::Status reopened = reopen_job(id);
    if (reopened || reopened.error().code == core::ErrorCode::kNotFound) continue;
    spdlog::error("job {} was rendered in part by a worker that is quarantined, and cannot be verified: {}",
                  id, reopened.error().message);
  }
}

core::Status Coordinator::reopen_job(const std::string& id) {
  while (true) {
    auto preparation = prepare_extension(id);
    if (!preparation) return core::fail(preparation.error());
    StateLock lock(*this);
    JobRecord* record = find(id);
    if (record == nullptr || record->revision != preparation->revision) continue;  // changed meanwhile
    if (needs_film(lock, *record) && !preparation->film) continue;                 // stored meanwhile
    if (auto may = may_continue(*record); !may) return may;
    if (!record->film) record->film = std::move(preparation->film);
    const scheduler::Actions actions = scheduler_.handle(scheduler::ReopenJob{{id}}, lock.now());
    apply(lock, actions);
    return actions.status;
  }
}

}  // namespace tessera::coordinator
