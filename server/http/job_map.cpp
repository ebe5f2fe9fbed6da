// SPDX-License-Identifier: Apache-2.0
// The route of a job's map: the samples of each tile of one image, and who renders it.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/view/tile_statistics.hpp"
#include "proto/json.hpp"
#include "server/farm/state_lock.hpp"
#include "server/http/answers.hpp"
#include "server/http/handlers.hpp"
#include "server/http/read_json.hpp"
#include "server/jobs/find_job.hpp"

namespace tessera::http_api {

namespace {

// What is looked at in one hold of the state lock, which takes about a microsecond for each.
constexpr std::size_t kLeasesAtOnce = 32;
constexpr std::size_t kTilesAtOnce = 16;
// Of larger images, only those who render at this moment are told.
constexpr std::size_t kMaxTilesWithProducers = 1 << 14;

constexpr std::chrono::milliseconds kNoiseTime{100};

struct MapTile {
  std::uint64_t samples = 0;
  bool is_leased = false;
  int worker = -1;  // its place in Map::workers
  std::optional<float> noise{};
};

struct Map {
  Map(const scheduler::JobGrid& grid, std::uint32_t image)
      : first(grid.first_tile(static_cast<int>(image))),
        tiles(static_cast<std::size_t>(grid.tiles_per_image())) {}

  const int first;                                           // the number of its first tile in the job
  std::vector<std::pair<std::string, std::string>> workers;  // ids and names
  std::map<std::string, int> places;                         // of workers, by id
  std::vector<MapTile> tiles;

  int place_of(const std::string& id, const std::string& name) {
    const auto [known, is_new] = places.try_emplace(id, static_cast<int>(workers.size()));
    if (is_new) workers.emplace_back(id, name);
    return known->second;
  }
  int of_job(std::size_t tile) const { return first + static_cast<int>(tile); }
  // Null if the tile of the job belongs to another image.
  MapTile* find(int of_job) {
    const auto tile = static_cast<std::size_t>(of_job - first);
    return of_job >= first && tile < tiles.size() ? &tiles[tile] : nullptr;
  }
};

std::uint64_t samples_in(const film::TileSnapshot& parts) {
  std::uint64_t samples = parts.stored.count();
  if (parts.storing) samples += parts.storing->samples().count();
  if (parts.newest) samples += parts.newest->samples().count();
  return samples;
}

void add_samples(const film::JobFilm& film, Map& map) {
  for (std::size_t tile = 0; tile < map.tiles.size(); ++tile)
    map.tiles[tile].samples = samples_in(film.snapshot(map.of_job(tile)));
}

core::Status add_stored_samples(store::JobStore& store, const std::string& job_id, Map& map) {
  const auto done = store.tiles_done(job_id);
  if (!done) return core::fail(done.error());
  for (const auto& [of_job, ranges] : *done) {
    MapTile* const tile = map.find(of_job);
    if (tile == nullptr) continue;
    for (const core::SampleRange& range : ranges) tile->samples += range.count();
  }
  return {};
}

// The noise of tiles that can be read in time; each tile is read once for each of its revisions.
core::Status add_noise(TileViews& views, watch::JobTiles& source, Map& map) {
  const auto states =
      view::read_tile_states(source, views.tiles(), std::chrono::steady_clock::now() + kNoiseTime);
  if (!states) return core::fail(states.error());
  for (std::size_t i = 0; i < std::min(states->size(), map.tiles.size()); ++i)
    if ((*states)[i]) map.tiles[i].noise = (*states)[i]->noise;
  return {};
}

// Who rendered samples that nobody has verified.
void add_producers(farm::Farm& farm, const std::string& job_id, Map& map) {
  const std::size_t count = map.tiles.size();
  if (count > kMaxTilesWithProducers) return;
  for (std::size_t first = 0; first < count; first += kTilesAtOnce) {
    const farm::StateLock lock(farm);
    if (lock->find_job(job_id) == nullptr) return;
    for (std::size_t tile = first; tile < std::min(count, first + kTilesAtOnce); ++tile) {
      const auto items = lock->scheduler.provenance({job_id}, map.of_job(tile));
      if (items.empty()) continue;
      const scheduler::Producer& last = items.back().producer;
      map.tiles[tile].worker = map.place_of(last.worker.value, last.name);
    }
  }
}

void add_leases(farm::Farm& farm, const std::string& job_id, Map& map) {
  std::optional<scheduler::LeaseId> after = scheduler::LeaseId{};
  while (after) {
    const farm::StateLock lock(farm);
    const scheduler::LeasePage page = lock->scheduler.leased_tiles({job_id}, *after, kLeasesAtOnce);
    for (const scheduler::LeasedTile& leased : page.tiles) {
      MapTile* const tile = map.find(leased.tile);
      if (tile == nullptr) continue;
      const scheduler::WorkerInfo* const info = lock->scheduler.worker_info(leased.holder);
      tile->is_leased = true;
      tile->worker = map.place_of(leased.holder.value, info == nullptr ? "" : info->name);
    }
    after = page.last;
  }
}

std::string tiles_text(const Map& map) {
  std::string text;
  for (const MapTile& tile : map.tiles)
    text += fmt::format("{}[{},{},{},{}]", text.empty() ? "" : ",", tile.samples, tile.is_leased ? 1 : 0,
                        tile.worker, tile.noise ? fmt::format("{:.4g}", *tile.noise) : "null");
  return text;
}

}  // namespace

Answer get_map(const CallPtr& call) {
  server::Coordinator& coordinator = call->coordinator();
  const auto found = jobs::find_job(coordinator.farm(), coordinator.store(), call->id());
  if (!found) return core::fail(found.error());
  if (!found->snapshot.is_validated)
    return core::fail(core::ErrorCode::kFailedPrecondition,
                      fmt::format("job {} has no image, since its scene was not validated", call->id()));
  const auto image = read_image_index(call->request);
  if (!image) return core::fail(image.error());
  const auto source = call->context.tiles.source(call->id(), *image);
  if (!source) return core::fail(source.error());
  const scheduler::JobGrid all = farm::grid_of(*found->snapshot.spec);
  const core::TileGrid& grid = all.of_image();
  Map map(all, *image);
  if (found->film) {
    found->film->apply();
    add_samples(*found->film, map);
    add_producers(coordinator.farm(), call->id(), map);
    add_leases(coordinator.farm(), call->id(), map);
  } else if (auto added = add_stored_samples(coordinator.store(), call->id(), map); !added) {
    return core::fail(added.error());
  }
  if (auto added = add_noise(call->context.tiles, **source, map); !added) return core::fail(added.error());
  Json workers = Json::array();
  for (const auto& [id, name] : map.workers) workers.push_back({{"id", id}, {"name", name}});
  const Json head = {{"tile_width", grid.tile_px()},
                     {"tile_height", grid.tile_px()},
                     {"columns", grid.columns()},
                     {"rows", grid.rows()},
                     {"workers", std::move(workers)}};
  // Tiles are too many for a tree of values each.
  std::string body = proto::to_line(head);
  body.pop_back();
  return json_text_response(body + ",\"tiles\":[" + tiles_text(map) + "]}");
}

}  // namespace tessera::http_api
