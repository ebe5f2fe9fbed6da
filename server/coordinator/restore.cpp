// Taking up the jobs of an earlier run.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "server/coordinator/loaded_film.hpp"
#include "server/coordinator/turn.hpp"
#include "server/coordinator/wire.hpp"

namespace tessera::coordinator {

namespace {

using DoneByTile = std::map<int, std::vector<core::SampleRange>>;

// A job was extended when its tiles have more samples than its row says: the row is written after them.
std::uint32_t spp_of(const store::JobRow& row, const DoneByTile& done) {
  std::uint32_t spp = row.spp;
  for (const auto& [tile, ranges] : done) {
    if (!ranges.empty()) spp = std::max(spp, ranges.back().end);
  }
  return spp;
}

bool is_complete(const scheduler::JobShape& shape, const DoneByTile& done) {
  const std::vector<core::SampleRange> all{{0, shape.spp}};
  return done.size() == static_cast<std::size_t>(shape.grid().tile_count()) &&
         std::all_of(done.begin(), done.end(), [&](const auto& tile) { return tile.second == all; });
}

std::vector<scheduler::IntervalSet> done_sets(const scheduler::JobShape& shape, const DoneByTile& done) {
  std::vector<scheduler::IntervalSet> sets(static_cast<std::size_t>(shape.grid().tile_count()));
  for (const auto& [tile, ranges] : done) {
    if (tile < 0 || tile >= shape.grid().tile_count()) continue;
    for (const core::SampleRange& range : ranges) sets[static_cast<std::size_t>(tile)].add(range);
  }
  return sets;
}

}  // namespace

core::Status Coordinator::restore_job(const store::JobRow& row) {
  auto record = from_row(row);
  if (!record) return core::fail(record.error());
  auto done = state_.jobs.tiles_done(row.id);
  if (!done) return core::fail(done.error());
  const auto state = from_wire(static_cast<v1::JobState>(row.state));
  const scheduler::JobShape shape = shape_of(*record->spec, spp_of(row, *done));

  const bool unfinished =
      !is_finished(state) || (state == scheduler::JobState::kDone && !is_complete(shape, *done));
  if (unfinished) {
    auto loaded = load_film(*record->spec);
    if (!loaded) return core::fail(loaded.error());
    for (const std::string& damage : loaded->damage) spdlog::error("{}: it is rendered again", damage);
    record->film = std::move(loaded->film);
    *done = std::move(loaded->done);
    if (arithmetic_.empty()) arithmetic_ = record->arithmetic;
  }

  Turn turn(*this);
  const scheduler::RestoreJob event{{row.id}, shape,       row.priority,
                                    state,    row.failure, done_sets(shape, *done)};
  const scheduler::Actions actions = scheduler_.handle(event, turn.now());
  if (!actions.status) return core::fail(actions.status.error().within("taking up job " + row.id));
  if (!record->request_id.empty()) job_of_request_[record->request_id] = row.id;
  jobs_.emplace(row.id, std::move(*record));
  apply(turn, actions);
  return {};
}

core::Result<Coordinator::LoadedFilm> Coordinator::load_film(const v1::Job& spec) {
  const core::TileGrid grid = grid_of(spec);
  auto done = state_.jobs.tiles_done(spec.id());
  if (!done) return core::fail(done.error());
  LoadedFilm loaded{std::make_unique<JobFilm>(grid), {}, {}};
  for (const auto& [tile, ranges] : *done) {
    if (tile < 0 || tile >= grid.tile_count()) continue;
    auto content = load_tile(spec, grid, tile);
    if (content) {
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
  const auto row = state_.jobs.tile(spec.id(), tile);
  if (!row) return core::fail(row.error());
  if (*row) return decode_tile_row(**row, grid.rect(tile));
  const std::size_t channels = grid.rect(tile).pixel_count() * 3;
  return TileContent{{std::vector<std::uint64_t>(channels), std::vector<std::uint64_t>(channels), 0, 0}, {}};
}

}  // namespace tessera::coordinator
