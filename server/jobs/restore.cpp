// SPDX-License-Identifier: Apache-2.0
// Recovers the jobs of an earlier run.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>

#include "core/base/printable.hpp"
#include "core/common/log.hpp"
#include "server/farm/wire.hpp"
#include "server/film/stored_counters.hpp"
#include "server/film/stored_tile.hpp"
#include "server/jobs/admission.hpp"
#include "server/jobs/continuation.hpp"
#include "server/jobs/restore.hpp"

namespace tessera::jobs {

using farm::JobRecord;
using farm::StateLock;

namespace {

using DoneByTile = std::map<int, std::vector<core::SampleRange>>;

// If a tile has more samples than the row says, the job was extended: its row is written after its tiles. All
// tiles get as many.
scheduler::JobShape extended_to(scheduler::JobShape shape, const DoneByTile& done) {
  std::uint32_t most = 0;
  for (const auto& [tile, ranges] : done) {
    if (!ranges.empty() && ranges.back().end > shape.target(tile)) most = std::max(most, ranges.back().end);
  }
  if (most > 0) shape.raise(std::max(most, shape.spp));
  return shape;
}

bool is_whole(const std::vector<core::SampleRange>& ranges, std::uint32_t spp) {
  return ranges == std::vector<core::SampleRange>{{0, spp}};
}

}  // namespace

std::vector<scheduler::IntervalSet> done_sets(const scheduler::JobShape& shape, const DoneByTile& done) {
  std::vector<scheduler::IntervalSet> sets(static_cast<std::size_t>(shape.grid().tile_count()));
  const int tiles = static_cast<int>(sets.size());
  for (const auto& [tile, ranges] : done) {
    if (tile < 0 || tile >= tiles) continue;
    for (const core::SampleRange& range : ranges) {
      if (range.begin < range.end && range.end <= shape.target(tile))
        sets[static_cast<std::size_t>(tile)].add(range);
    }
  }
  return sets;
}

core::Status Restoration::restore_all() {
  const auto ids = state_.jobs.unsettled_jobs();
  if (!ids) return core::fail(ids.error());
  for (const std::string& id : *ids) {
    auto row = state_.jobs.job(id);
    if (!row) return core::fail(row.error());
    if (!*row) continue;
    if (auto restored = restore(**std::move(row)); !restored) return restored;
  }
  if (auto written = flush(); !written) return written;
  if (restored_ > 0) spdlog::info("recovered {} jobs from the state directory", restored_);
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
  common::log(spdlog::level::err, error.message, {.job = row.id});
  const scheduler::JobView view = farm::snapshot_of_damaged(row, error).view;
  const scheduler::RestoreJob event{view.id,          view.shape,   view.priority,
                                    view.state,       view.failure, done_sets(view.shape, {}),
                                    view.max_workers, {},           view.failure_details};
  return add_restored(event, farm::record_of_damaged(row));
}

core::Status Restoration::add_restored(const scheduler::RestoreJob& event, JobRecord record) {
  record.files = files_.hold(record.spec->bundle());
  files_.charge_to(record.spec->owner(), record.spec->bundle());
  StateLock lock(farm_);
  if (auto added = lock.add_job(event, std::move(record)); !added) return added;
  ++restored_;
  return {};
}

core::Status Restoration::restore_validating(const store::JobRow& row) {
  auto job = farm::validating_from_row(row);
  if (!job) return restore_damaged(row, job.error());
  job->files = files_.hold(job->spec->bundle());
  files_.charge_to(job->spec->owner(), job->spec->bundle());
  StateLock(farm_).add_validating(*std::move(job));
  ++restored_;
  return {};
}

core::Status Restoration::restore(store::JobRow row) {
  if (row.state == v1::JOB_STATE_VALIDATING) return restore_validating(row);
  auto record = farm::from_row(row);
  if (!record) return restore_damaged(row, record.error());
  const bool is_of_earlier_release = row.bundle.empty();
  if (is_of_earlier_release) {
    const std::int64_t created_ms = row.created_ms;
    row = farm::to_row(farm::snapshot_of_row(row));
    row.created_ms = created_ms;
  }
  const auto state = farm::from_wire(static_cast<v1::JobState>(row.state));
  if (farm::is_finished(state)) {
    const scheduler::JobShape shape =
        record->is_validated ? farm::shape_of(*record->spec, row) : farm::kNoShape;
    auto done = state_.jobs.tiles_done(row.id);
    if (!done) return core::fail(done.error());
    const auto lacks = state == scheduler::JobState::kDone ? lacks_samples(row, shape, *done) : false;
    if (!lacks) return core::fail(lacks.error());
    if (!*lacks) return settle(std::move(row), shape, *done);
  }
  if (is_of_earlier_release)
    if (auto written = rewrite(row); !written) return written;
  return restore_unfinished(row, std::move(*record));
}

core::Status Restoration::restore_unfinished(const store::JobRow& row, JobRecord record) {
  // Its workers cannot join this farm. The row stays unchanged for a coordinator that accepts them.
  if (auto may = may_continue(record, fingerprints_); !may) return restore_damaged(row, may.error());
  // The limits may have been higher, or the row is damaged: the film would not fit into memory.
  if (auto fits = check_image_size(record.spec->settings(), limits_); !fits)
    return restore_damaged(row, fits.error().within("recovering job " + row.id));
  auto loaded = films_.load(*record.spec);
  if (!loaded) return core::fail(loaded.error());
  for (const std::string& damage : loaded->damage)
    common::log(spdlog::level::err, damage + ": it is rendered again", {.job = row.id});
  record.film = std::move(loaded->film);
  // Unchecked rows cannot raise a job's sample count.
  const scheduler::JobShape shape = extended_to(farm::shape_of(*record.spec, row), loaded->done);
  const scheduler::RestoreJob event{{row.id},
                                    shape,
                                    row.priority,
                                    farm::from_wire(static_cast<v1::JobState>(row.state)),
                                    row.failure,
                                    done_sets(shape, loaded->done),
                                    row.max_workers,
                                    std::move(loaded->provenance),
                                    {},
                                    record.arithmetic};
  const core::Status restored = add_restored(event, std::move(record));
  return restored ? restored : restore_damaged(row, restored.error().within("recovering job " + row.id));
}

// Its counters may be those of an earlier moment.
core::Status Restoration::settle(store::JobRow row, const scheduler::JobShape& shape,
                                 const DoneByTile& done) {
  const scheduler::JobGrid grid = shape.grid();
  std::vector<std::uint64_t> samples(static_cast<std::size_t>(grid.image_count()));
  const std::vector<scheduler::IntervalSet> sets = done_sets(shape, done);
  for (int tile = 0; tile < grid.tile_count(); ++tile)
    samples[static_cast<std::size_t>(grid.image_of(tile))] +=
        sets[static_cast<std::size_t>(tile)].count() * grid.rect(tile).pixel_count();
  stored::v1::Counters counters;
  if (!counters.ParseFromString(row.counters)) counters.Clear();
  counters.set_samples(std::accumulate(samples.begin(), samples.end(), std::uint64_t{0}));
  counters.clear_samples_by_image();
  if (samples.size() > 1) counters.mutable_samples_by_image()->Add(samples.begin(), samples.end());
  row.counters = counters.SerializeAsString();
  row.settled = true;
  return rewrite(std::move(row));
}

core::Status Restoration::rewrite(store::JobRow row) {
  constexpr std::size_t kRowsAtOnce = 256;
  to_rewrite_.push_back(std::move(row));
  return to_rewrite_.size() < kRowsAtOnce ? core::Status() : flush();
}

core::Status Restoration::flush() {
  const std::vector<store::JobRow> rows = std::exchange(to_rewrite_, {});
  return rows.empty() ? core::Status() : state_.jobs.rewrite_jobs(rows);
}

// Whether a job that is stored as done lacks samples in intact tiles: the coordinator crashed after the job
// was extended. Tiles with damaged rows count as done, and the damage is reported with the image; `done` is
// updated accordingly.
core::Result<bool> Restoration::lacks_samples(const store::JobRow& row, const scheduler::JobShape& shape,
                                              std::map<int, std::vector<core::SampleRange>>& done) {
  bool lacks = false;
  const int tiles = shape.grid().tile_count();
  for (int tile = 0; tile < tiles; ++tile) {
    const std::uint32_t target = shape.target(tile);
    if (is_whole(done[tile], target)) continue;
    const auto stored = state_.jobs.tile(row.id, tile);
    if (!stored && stored.error().code != core::ErrorCode::kDataLoss) return core::fail(stored.error());
    if (stored) {
      lacks = true;
    } else {
      common::log(spdlog::level::err, stored.error().message, {.job = row.id});
      done[tile] = {{0, target}};
    }
  }
  return lacks;
}

}  // namespace tessera::jobs
