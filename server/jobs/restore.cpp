// SPDX-License-Identifier: Apache-2.0
// Recovers the jobs of an earlier run.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "core/base/printable.hpp"
#include "server/farm/wire.hpp"
#include "server/film/stored_tile.hpp"
#include "server/jobs/admission.hpp"
#include "server/jobs/continuation.hpp"
#include "server/jobs/restore.hpp"

namespace tessera::jobs {

using farm::JobRecord;
using farm::StateLock;

namespace {

using DoneByTile = std::map<int, std::vector<core::SampleRange>>;

// If the tiles have more samples than the row says, the job was extended: its row is written after them.
std::uint32_t spp_of(const store::JobRow& row, const DoneByTile& done) {
  std::uint32_t spp = row.spp;
  for (const auto& [tile, ranges] : done) {
    if (!ranges.empty()) spp = std::max(spp, ranges.back().end);
  }
  return spp;
}

bool is_whole(const std::vector<core::SampleRange>& ranges, std::uint32_t spp) {
  return ranges == std::vector<core::SampleRange>{{0, spp}};
}

std::vector<scheduler::IntervalSet> done_sets(const scheduler::JobShape& shape, const DoneByTile& done) {
  std::vector<scheduler::IntervalSet> sets(static_cast<std::size_t>(shape.grid().tile_count()));
  for (const auto& [tile, ranges] : done) {
    if (tile < 0 || tile >= shape.grid().tile_count()) continue;
    for (const core::SampleRange& range : ranges) {
      if (range.begin < range.end && range.end <= shape.spp) sets[static_cast<std::size_t>(tile)].add(range);
    }
  }
  return sets;
}

}  // namespace

core::Status Restoration::restore_all() {
  const auto rows = state_.jobs.jobs();
  if (!rows) return core::fail(rows.error());
  for (const store::JobRow& row : *rows) {
    if (auto restored = restore(row); !restored) return restored;
  }
  if (!rows->empty()) spdlog::info("recovered {} jobs from the state directory", rows->size());
  return {};
}

// A damaged job must not keep all others from being recovered: it is shown as failed, and can be deleted. Its
// row stays unchanged. A job whose id is no UTF-8 cannot be shown or deleted, so it is skipped.
core::Status Restoration::restore_damaged(const store::JobRow& row, const core::Error& error) {
  if (!farm::is_text(row.id)) {
    spdlog::error("a stored job with a damaged id, {}, is skipped: --salvage keeps the others",
                  core::printable(row.id));
    return {};
  }
  spdlog::error("{}", error.message);
  const scheduler::JobShape nothing{1, 1, 1};
  auto spec = std::make_shared<v1::Job>();
  spec->set_id(row.id);
  spec->set_name("(damaged)");
  spec->mutable_settings()->set_width_px(1);
  spec->mutable_settings()->set_height_px(1);
  *spec->mutable_created_at() = farm::timestamp_from_ms(row.created_ms);
  // Its files stay if they can be read, since the next start may recover the job.
  if (const auto readable = farm::from_row(row)) *spec->mutable_bundle() = readable->spec->bundle();
  JobRecord record;
  record.spec = std::move(spec);
  record.request_id = row.request_id;
  record.revision = record.stored_revision = row.revision;
  record.finished_ms = row.finished_ms;

  const scheduler::RestoreJob event{{row.id},       nothing,
                                    row.priority,   scheduler::JobState::kFailed,
                                    error.message,  done_sets(nothing, {}),
                                    row.max_workers};
  return add_restored(event, std::move(record));
}

core::Status Restoration::add_restored(const scheduler::RestoreJob& event, JobRecord record) {
  record.files = files_.hold(record.spec->bundle());
  files_.charge_to(record.spec->submitter(), record.spec->bundle());
  StateLock lock(farm_);
  const scheduler::Actions actions = lock->scheduler.handle(event, lock.now());
  if (!actions.status) return core::fail(actions.status.error());
  lock->add_job(std::move(record));
  lock.apply(actions);
  return {};
}

core::Status Restoration::restore(const store::JobRow& row) {
  auto record = farm::from_row(row);
  if (!record) return restore_damaged(row, record.error());
  auto state = farm::from_wire(static_cast<v1::JobState>(row.state));
  auto done = state_.jobs.tiles_done(row.id);
  if (!done) return core::fail(done.error());

  std::vector<scheduler::ProducedItem> provenance;
  bool unfinished = !farm::is_finished(state);
  if (state == scheduler::JobState::kDone) {
    auto lacks = lacks_samples(row, farm::grid_of(*record->spec), *done);
    if (!lacks) return core::fail(lacks.error());
    unfinished = *lacks;
  }
  if (unfinished) {
    // Its workers cannot join this farm. The row stays unchanged for a coordinator that accepts them.
    if (auto may = may_continue(*record, fingerprint_); !may) return restore_damaged(row, may.error());
    // The limits may have been higher, or the row is damaged: the film would not fit into memory.
    if (auto fits = check_picture_size(record->spec->settings(), limits_); !fits)
      return restore_damaged(row, fits.error().within("recovering job " + row.id));
    auto loaded = films_.load(*record->spec);
    if (!loaded) return core::fail(loaded.error());
    for (const std::string& damage : loaded->damage) spdlog::error("{}: it is rendered again", damage);
    record->film = std::move(loaded->film);
    *done = std::move(loaded->done);
    provenance = std::move(loaded->provenance);
  }
  // Unchecked rows cannot raise a job's sample count.
  const scheduler::JobShape shape = farm::shape_of(*record->spec, unfinished ? spp_of(row, *done) : row.spp);

  const scheduler::RestoreJob event{{row.id},        shape,
                                    row.priority,    state,
                                    row.failure,     done_sets(shape, *done),
                                    row.max_workers, std::move(provenance)};
  const core::Status taken_up = add_restored(event, std::move(*record));
  return taken_up ? taken_up : restore_damaged(row, taken_up.error().within("recovering job " + row.id));
}

// Whether a job that is stored as done lacks samples in intact tiles: the coordinator crashed after the job
// was extended. Tiles with damaged rows count as done, and the damage is reported with the image; `done` is
// updated accordingly.
core::Result<bool> Restoration::lacks_samples(const store::JobRow& row, const core::TileGrid& grid,
                                              std::map<int, std::vector<core::SampleRange>>& done) {
  bool lacks = false;
  for (int tile = 0; tile < grid.tile_count(); ++tile) {
    if (is_whole(done[tile], row.spp)) continue;
    const auto stored = state_.jobs.tile(row.id, tile);
    if (!stored && stored.error().code != core::ErrorCode::kDataLoss) return core::fail(stored.error());
    if (stored) {
      lacks = true;
    } else {
      spdlog::error("{}", stored.error().message);
      done[tile] = {{0, row.spp}};
    }
  }
  return lacks;
}

}  // namespace tessera::jobs
