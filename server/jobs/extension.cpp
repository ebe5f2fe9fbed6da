// SPDX-License-Identifier: Apache-2.0
// Extends jobs. The store alone has the films of done jobs: they are read back without the state lock.
#include <fmt/format.h>

#include <optional>
#include <thread>
#include <utility>

#include "proto/convert.hpp"
#include "server/farm/wire.hpp"
#include "server/jobs/admission.hpp"
#include "server/jobs/continuation.hpp"
#include "server/jobs/find_job.hpp"
#include "server/jobs/job_service.hpp"
#include "server/jobs/quota.hpp"
#include "server/jobs/restore.hpp"

namespace tessera::jobs {

using core::ErrorCode;
using farm::JobRecord;
using farm::JobSnapshot;
using farm::StateLock;
using scheduler::JobState;

namespace {

core::Status may_have_spp(const v1::Job& spec, std::uint32_t spp, const server::Limits& limits) {
  v1::RenderSettings settings = spec.settings();
  settings.set_spp(spp);
  if (const auto possible = proto::from_proto(settings); !possible) return core::fail(possible.error());
  return check_spp(spp, limits);
}

core::Status may_extend(const StateLock& lock, const JobRecord& record, std::uint32_t spp,
                        const server::Limits& limits) {
  const scheduler::JobView view = *lock->scheduler.job({record.spec->id()}, lock.now());
  if (!scheduler::takes_results(view.state)) return {};  // the scheduler refuses it
  if (const auto may = may_have_spp(*record.spec, spp, limits); !may) return may;
  if (view.state == JobState::kDone && spp > view.shape.spp)
    if (const auto may = may_open_job(lock, record.spec->owner(), limits); !may) return may;
  return may_continue(record, lock.options().fingerprints);
}

}  // namespace

core::Result<v1::Job> JobService::extend(const std::string& id, std::uint32_t spp) {
  for (;;) {
    if (auto extended = extend_in_memory(id, spp)) return *std::move(extended);
    if (auto extended = extend_stored(id, spp)) return *std::move(extended);
    std::this_thread::yield();
  }
}

std::optional<core::Result<v1::Job>> JobService::extend_in_memory(const std::string& id, std::uint32_t spp) {
  const auto changed = [&]() -> std::optional<core::Result<JobSnapshot>> {
    StateLock lock(farm_);
    if (lock->find_validating(id) != nullptr) return core::fail(is_being_validated(id));
    JobRecord* const record = lock->find_job(id);
    if (record == nullptr) return std::nullopt;
    if (auto may = may_extend(lock, *record, spp, limits_); !may) return core::fail(may.error());
    if (const auto done = lock.handle(scheduler::ExtendJob{{id}, spp}).status; !done)
      return core::fail(done.error());
    lock.change(*record);
    return lock.snapshot_of(*record);
  }();
  if (!changed) return std::nullopt;
  return store_change(*changed);
}

std::optional<core::Result<v1::Job>> JobService::extend_stored(const std::string& id, std::uint32_t spp) {
  auto row = state_.jobs.job(id);
  if (!row) return core::fail(row.error());
  if (!*row) return core::fail(no_job(id));
  if (!(*row)->settled) return std::nullopt;
  const auto record = farm::from_row(**row);
  if (!record) return core::fail(record.error());
  const JobSnapshot job = farm::snapshot_of_row(**row);
  if (auto may = answer_of_finished(job, scheduler::ExtendJob{{id}, spp}); !may)
    return core::fail(may.error());
  if (auto may = may_have_spp(*record->spec, spp, limits_); !may) return core::fail(may.error());
  if (spp == job.view.shape.spp) return describe(job);
  const auto place = QuotaReservation::take(farm_, record->spec->owner(), limits_);
  if (!place) return core::fail(place.error());
  if (auto may = may_continue(*record, farm_.options().fingerprints); !may) return core::fail(may.error());
  if (auto room = check_film_memory(farm::grid_of(*record->spec), film_memory_); !room)
    return core::fail(room.error());
  const auto is_back = bring_back(**std::move(row), JobState::kRunning, spp);
  if (!is_back) return core::fail(is_back.error());
  if (!*is_back) return std::nullopt;
  return get(id);
}

core::Result<bool> JobService::bring_back(store::JobRow row, JobState state, std::uint32_t spp) {
  auto record = farm::from_row(row);
  if (!record) return core::fail(record.error());
  record->files = files_.hold(record->spec->bundle());
  auto loaded = films_.load(*record->spec);
  if (!loaded) return core::fail(loaded.error());
  if (!loaded->damage.empty())
    return core::fail(ErrorCode::kDataLoss, loaded->damage.front() + ": delete the job and submit it again");
  record->film = std::move(loaded->film);
  const std::uint64_t before = row.revision;
  row.revision = farm_.events().counter().next();
  row.settled = false;
  row.spp = spp;
  row.state = farm::to_wire(state);
  if (!farm::is_finished(state)) row.finished_ms.reset();
  record->revision = record->stored_revision = record->last_event = row.revision;
  record->finished_ms = row.finished_ms;

  // The row first: a start of the coordinator looks at the job again.
  const std::lock_guard nobody_deletes_it(moving_mutex_);
  const auto is_same = state_.jobs.replace_job(row, before);
  if (!is_same || !*is_same) return is_same;
  const scheduler::JobShape shape = farm::shape_of(*record->spec, spp);
  const scheduler::RestoreJob event{{row.id},
                                    shape,
                                    row.priority,
                                    state,
                                    row.failure,
                                    done_sets(shape, loaded->done),
                                    row.max_workers,
                                    std::move(loaded->provenance),
                                    {},
                                    row.arithmetic};
  StateLock lock(farm_);
  const scheduler::Actions actions = lock->scheduler.handle(event, lock.now());
  if (!actions.status) return core::fail(actions.status.error());
  lock->add_job(*std::move(record));
  lock.apply(actions);
  // Workers may have been distrusted since it was stored.
  lock.handle(scheduler::ReopenJob{{row.id}});
  return true;
}

}  // namespace tessera::jobs
