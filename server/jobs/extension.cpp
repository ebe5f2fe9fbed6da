// SPDX-License-Identifier: Apache-2.0
// Extends jobs. The store alone has the films of done jobs: they are read back without the state lock.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <thread>
#include <utility>

#include "proto/convert.hpp"
#include "server/base/wall_clock.hpp"
#include "server/farm/stored_job.hpp"
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

core::Status may_have_spp(const v1::Job& spec, const scheduler::ExtendJob& event,
                          const server::Limits& limits) {
  std::uint32_t most = event.spp;
  for (const scheduler::TileTarget& tile : event.tiles) most = std::max(most, tile.spp);
  v1::RenderSettings settings = spec.settings();
  settings.set_spp(most);
  if (const auto possible = proto::from_proto(settings); !possible) return core::fail(possible.error());
  return check_spp(most, limits);
}

// INVALID_ARGUMENT if a rectangle is no tile of the job.
core::Result<scheduler::ExtendJob> event_of(const v1::ExtendJobRequest& request, const v1::Job& spec) {
  scheduler::ExtendJob event{{request.job_id()}, request.spp()};
  const scheduler::JobGrid grid = farm::grid_of(spec);
  for (int i = 0; i < request.tiles_size(); ++i) {
    const v1::TileTarget& target = request.tiles(i);
    const auto rect = proto::from_proto(target.rect());
    const int tile = rect ? grid.find(target.image(), *rect) : scheduler::kNoTile;
    if (tile == scheduler::kNoTile)
      return core::fail(ErrorCode::kInvalidArgument,
                        fmt::format("tiles[{}]: image and rect are no tile of job {}", i, request.job_id()));
    event.tiles.push_back({tile, target.spp()});
  }
  return event;
}

core::Status may_extend(const StateLock& lock, const JobRecord& record, const scheduler::ExtendJob& event,
                        const server::Limits& limits) {
  const scheduler::JobView view = *lock->scheduler.job({record.spec->id()}, lock.now());
  if (!scheduler::takes_results(view.state)) return {};  // the scheduler refuses it
  if (const auto may = may_have_spp(*record.spec, event, limits); !may) return may;
  if (view.state == JobState::kDone && view.shape.is_raised_by(event.spp, event.tiles))
    if (const auto may = may_open_job(lock, record.spec->owner(), limits); !may) return may;
  return may_continue(record, lock.options().fingerprints);
}

}  // namespace

core::Result<v1::Job> JobService::extend(const std::string& id, std::uint32_t spp) {
  v1::ExtendJobRequest request;
  request.set_job_id(id);
  request.set_spp(spp);
  return extend(request);
}

core::Result<v1::Job> JobService::extend(const v1::ExtendJobRequest& request) {
  for (;;) {
    if (auto extended = extend_in_memory(request)) return *std::move(extended);
    if (auto extended = extend_stored(request)) return *std::move(extended);
    std::this_thread::yield();
  }
}

std::optional<core::Result<v1::Job>> JobService::extend_in_memory(const v1::ExtendJobRequest& request) {
  const std::string& id = request.job_id();
  const auto changed = [&]() -> std::optional<core::Result<JobSnapshot>> {
    StateLock lock(farm_);
    if (auto enough = lock.expect_memory(); !enough) return core::fail(enough.error());
    if (lock->find_validating(id) != nullptr) return core::fail(is_being_validated(id));
    JobRecord* const record = lock->find_job(id);
    if (record == nullptr) return std::nullopt;
    const auto event = event_of(request, *record->spec);
    if (!event) return core::fail(event.error());
    if (auto may = may_extend(lock, *record, *event, limits_); !may) return core::fail(may.error());
    const bool is_more = lock->scheduler.job({id}, lock.now())->shape.is_raised_by(event->spp, event->tiles);
    if (const auto done = lock.handle(*event).status; !done) return core::fail(done.error());
    if (is_more) record->life.note(v1::JobEvent::KIND_EXTENDED, base::wall_clock_ms());
    lock.change(*record);
    return lock.snapshot_of(*record);
  }();
  if (!changed) return std::nullopt;
  return store_change(*changed);
}

std::optional<core::Result<v1::Job>> JobService::extend_stored(const v1::ExtendJobRequest& request) {
  const std::string& id = request.job_id();
  auto row = state_.jobs.job(id);
  if (!row) return core::fail(row.error());
  if (!*row) return core::fail(no_job(id));
  if (!(*row)->settled) return std::nullopt;
  const auto record = farm::from_row(**row);
  if (!record) return core::fail(record.error());
  const JobSnapshot job = farm::snapshot_of_row(**row);
  const auto event = event_of(request, *record->spec);
  if (!event) return core::fail(event.error());
  const bool only_tiles = event->spp == 0 && !event->tiles.empty();
  const scheduler::ExtendJob of_all{{id}, only_tiles ? job.view.shape.spp : event->spp};
  if (auto may = answer_of_finished(job, of_all); !may) return core::fail(may.error());
  if (auto may = may_have_spp(*record->spec, *event, limits_); !may) return core::fail(may.error());
  scheduler::JobShape shape = job.view.shape;
  if (!shape.is_raised_by(event->spp, event->tiles)) return describe(job);
  shape.raise(event->spp, event->tiles);
  if (auto possible = scheduler::check_shape(shape); !possible) return core::fail(possible.error());
  const auto place = QuotaReservation::take(farm_, record->spec->owner(), limits_);
  if (!place) return core::fail(place.error());
  if (auto may = may_continue(*record, farm_.options().fingerprints); !may) return core::fail(may.error());
  if (auto room = check_film_memory(shape, film_memory_); !room) return core::fail(room.error());
  const auto is_back = bring_back(**std::move(row), JobState::kRunning, shape);
  if (!is_back) return core::fail(is_back.error());
  if (!*is_back) return std::nullopt;
  return get(id);
}

core::Result<bool> JobService::bring_back(store::JobRow row, JobState state,
                                          const scheduler::JobShape& shape) {
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
  row.spp = shape.spp;
  row.targets = farm::encode_targets(shape.targets);
  row.state = farm::to_wire(state);
  if (!farm::is_finished(state)) {
    row.finished_ms.reset();
    for (const auto kind : {v1::JobEvent::KIND_RESUMED, v1::JobEvent::KIND_EXTENDED})
      record->life.note(kind, base::wall_clock_ms());
    row.counters = farm::counters_with(record->life, row.counters);
  }
  record->revision = record->stored_revision = record->last_event = row.revision;
  record->finished_ms = row.finished_ms;

  // The row first: a start of the coordinator looks at the job again.
  const core::MutexLock nobody_deletes_it(moving_mutex_);
  if (auto enough = StateLock(farm_).expect_memory(); !enough) return core::fail(enough.error());
  const auto is_same = state_.jobs.replace_job(row, before);
  if (!is_same || !*is_same) return is_same;
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
  if (auto added = lock.add_job(event, *std::move(record)); !added) return core::fail(added.error());
  // Workers may have been distrusted since it was stored.
  lock.handle(scheduler::ReopenJob{{row.id}});
  return true;
}

}  // namespace tessera::jobs
