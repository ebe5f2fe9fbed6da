// SPDX-License-Identifier: Apache-2.0
// Recovers the jobs of an earlier run.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "core/base/printable.hpp"
#include "server/coordinator/admission.hpp"
#include "server/coordinator/loaded_film.hpp"
#include "server/coordinator/state_lock.hpp"
#include "server/coordinator/stored_tile.hpp"
#include "server/coordinator/wire.hpp"

namespace tessera::coordinator {

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

// A damaged job must not keep all others from being recovered: it is shown as failed, and can be deleted. Its
// row stays unchanged. A job whose id is no UTF-8 cannot be shown or deleted, so it is skipped.
core::Status Coordinator::restore_damaged_job(const store::JobRow& row, const core::Error& error) {
  if (!is_text(row.id)) {
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
  *spec->mutable_created_at() = timestamp_from_ms(row.created_ms);
  // Its files stay if they can be read, since the next start may recover the job.
  if (const auto readable = from_row(row)) *spec->mutable_bundle() = readable->spec->bundle();
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

core::Status Coordinator::add_restored(const scheduler::RestoreJob& event, JobRecord record) {
  record.files = files_.hold(record.spec->bundle());
  files_.charge_to(record.spec->submitter(), record.spec->bundle());
  StateLock lock(*this);
  const scheduler::Actions actions = scheduler_.handle(event, lock.now());
  if (!actions.status) return core::fail(actions.status.error());
  if (!record.request_id.empty()) job_of_request_[record.request_id] = event.id.value;
  jobs_.emplace(event.id.value, std::move(record));
  apply(lock, actions);
  return {};
}

core::Status Coordinator::restore_job(const store::JobRow& row) {
  auto record = from_row(row);
  if (!record) return restore_damaged_job(row, record.error());
  auto state = from_wire(static_cast<v1::JobState>(row.state));
  auto done = state_.jobs.tiles_done(row.id);
  if (!done) return core::fail(done.error());

  std::vector<scheduler::ProducedItem> provenance;
  bool unfinished = !is_finished(state);
  if (state == scheduler::JobState::kDone) {
    auto lacks = lacks_samples(row, grid_of(*record->spec), *done);
    if (!lacks) return core::fail(lacks.error());
    unfinished = *lacks;
  }
  if (unfinished) {
    // Its workers cannot join this farm. The row stays unchanged for a coordinator that accepts them.
    if (auto may = may_continue(*record); !may) return restore_damaged_job(row, may.error());
    // The limits may have been higher, or the row is damaged: the film would not fit into memory.
    if (auto fits = check_picture_size(record->spec->settings(), options_.limits); !fits)
      return restore_damaged_job(row, fits.error().within("recovering job " + row.id));
    auto loaded = load_film(*record->spec);
    if (!loaded) return core::fail(loaded.error());
    for (const std::string& damage : loaded->damage) spdlog::error("{}: it is rendered again", damage);
    record->film = std::move(loaded->film);
    *done = std::move(loaded->done);
    provenance = std::move(loaded->provenance);
  }
  // Unchecked rows cannot raise a job's sample count.
  const scheduler::JobShape shape = shape_of(*record->spec, unfinished ? spp_of(row, *done) : row.spp);

  const scheduler::RestoreJob event{{row.id},        shape,
                                    row.priority,    state,
                                    row.failure,     done_sets(shape, *done),
                                    row.max_workers, std::move(provenance)};
  const core::Status taken_up = add_restored(event, std::move(*record));
  return taken_up ? taken_up : restore_damaged_job(row, taken_up.error().within("recovering job " + row.id));
}

// Whether a job that is stored as done lacks samples in intact tiles: the coordinator crashed after the job
// was extended. Tiles with damaged rows count as done, and the damage is reported with the image; `done` is
// updated accordingly.
core::Result<bool> Coordinator::lacks_samples(const store::JobRow& row, const core::TileGrid& grid,
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

// Drops fingerprints that a lost secret made, since they cannot be compared. Returns false if an audit needs
// one of them.
bool Coordinator::can_be_verified(Produced& provenance) const {
  if (provenance.fingerprinter == fingerprinter_.check()) return true;
  const bool due = std::any_of(provenance.items.begin(), provenance.items.end(),
                               [](const auto& each) { return each.due != scheduler::Due::kNo; });
  provenance.items.clear();
  return !due;
}

core::Result<Coordinator::LoadedFilm> Coordinator::load_film(const v1::Job& spec) {
  const core::TileGrid grid = grid_of(spec);
  auto done = state_.jobs.tiles_done(spec.id());
  if (!done) return core::fail(done.error());
  LoadedFilm loaded{std::make_unique<JobFilm>(grid), {}, {}, {}};
  for (const auto& [tile, ranges] : *done) {
    if (tile < 0 || tile >= grid.tile_count()) continue;
    auto content = load_tile(spec, grid, tile);
    if (content) {  // the ranges are those that were written
      if (!can_be_verified(content->provenance)) {
        loaded.damage.push_back(fmt::format(
            "tile {} of job {} was to be verified, and its fingerprints are of another state folder", tile,
            spec.id()));
        continue;
      }
      auto& items = content->provenance.items;
      loaded.provenance.insert(loaded.provenance.end(), items.begin(), items.end());
      loaded.film->restore(tile, std::move(*content));
      loaded.done[tile] = ranges;
    } else if (content.error().code == core::ErrorCode::kDataLoss) {
      loaded.damage.push_back(content.error().message);
    } else {
      return core::fail(content.error());
    }
  }
  return loaded;
}

core::Result<TileContent> Coordinator::load_tile(const v1::Job& spec, const core::TileGrid& grid, int tile) {
  auto stored = read_stored_tile(state_.jobs, spec.id(), grid, tile);
  if (stored) return std::move(stored->content);
  if (stored.error().code != core::ErrorCode::kNotFound) return core::fail(stored.error());
  const std::size_t channels = grid.rect(tile).pixel_count() * 3;
  return TileContent{
      {std::vector<std::uint64_t>(channels), std::vector<std::uint64_t>(channels), 0, 0}, {}, {}};
}

}  // namespace tessera::coordinator
