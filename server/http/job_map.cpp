// SPDX-License-Identifier: Apache-2.0
// The route of a job's map: the samples of each tile of its first image, and who renders it.
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
#include "server/jobs/find_job.hpp"

namespace tessera::http_api {

namespace {

// What is looked at in one hold of the state lock, which takes about a microsecond for each.
constexpr std::size_t kLeasesAtOnce = 32;
constexpr int kTilesAtOnce = 16;
// Of larger images, only those who render at this moment are told.
constexpr int kMaxTilesWithProducers = 1 << 14;

constexpr std::chrono::milliseconds kNoiseTime{100};

struct MapTile {
  std::uint64_t samples = 0;
  bool is_leased = false;
  int worker = -1;  // its place in Map::workers
  std::optional<float> noise{};
};

struct Map {
  std::vector<std::pair<std::string, std::string>> workers;  // ids and names
  std::map<std::string, int> places;                         // of workers, by id
  std::vector<MapTile> tiles;

  int place_of(const std::string& id, const std::string& name) {
    const auto [known, is_new] = places.try_emplace(id, static_cast<int>(workers.size()));
    if (is_new) workers.emplace_back(id, name);
    return known->second;
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
    map.tiles[tile].samples = samples_in(film.snapshot(static_cast<int>(tile)));
}

core::Status add_stored_samples(store::JobStore& store, const std::string& job_id, Map& map) {
  const auto done = store.tiles_done(job_id);
  if (!done) return core::fail(done.error());
  for (const auto& [tile, ranges] : *done) {
    if (tile < 0 || static_cast<std::size_t>(tile) >= map.tiles.size()) continue;
    for (const core::SampleRange& range : ranges)
      map.tiles[static_cast<std::size_t>(tile)].samples += range.count();
  }
  return {};
}

// The noise of tiles that can be read in time; each tile is read once for each of its revisions.
core::Status add_noise(TileViews& views, const std::string& job_id, Map& map) {
  const auto source = views.source(job_id);
  if (!source) return core::fail(source.error());
  const auto states =
      view::read_tile_states(**source, views.tiles(), std::chrono::steady_clock::now() + kNoiseTime);
  if (!states) return core::fail(states.error());
  for (std::size_t i = 0; i < std::min(states->size(), map.tiles.size()); ++i)
    if ((*states)[i]) map.tiles[i].noise = (*states)[i]->noise;
  return {};
}

// Who rendered samples that nobody has verified.
void add_producers(farm::Farm& farm, const std::string& job_id, Map& map) {
  const int count = static_cast<int>(map.tiles.size());
  if (count > kMaxTilesWithProducers) return;
  for (int first = 0; first < count; first += kTilesAtOnce) {
    const farm::StateLock lock(farm);
    if (lock->find_job(job_id) == nullptr) return;
    for (int tile = first; tile < std::min(count, first + kTilesAtOnce); ++tile) {
      const auto items = lock->scheduler.provenance({job_id}, tile);
      if (items.empty()) continue;
      const scheduler::Producer& last = items.back().producer;
      map.tiles[static_cast<std::size_t>(tile)].worker = map.place_of(last.worker.value, last.name);
    }
  }
}

void add_leases(farm::Farm& farm, const std::string& job_id, Map& map) {
  std::optional<scheduler::LeaseId> after = scheduler::LeaseId{};
  while (after) {
    const farm::StateLock lock(farm);
    const scheduler::LeasePage page = lock->scheduler.leased_tiles({job_id}, *after, kLeasesAtOnce);
    for (const scheduler::LeasedTile& leased : page.tiles) {
      if (static_cast<std::size_t>(leased.tile) >= map.tiles.size()) continue;  // of another image
      const scheduler::WorkerInfo* const info = lock->scheduler.worker_info(leased.holder);
      MapTile& tile = map.tiles.at(static_cast<std::size_t>(leased.tile));
      tile.is_leased = true;
      tile.worker = map.place_of(leased.holder.value, info == nullptr ? "" : info->name);
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
  const core::TileGrid grid = farm::grid_of(*found->snapshot.spec).of_image();
  Map map;
  map.tiles.resize(static_cast<std::size_t>(grid.tile_count()));
  if (found->film) {
    found->film->apply();
    add_samples(*found->film, map);
    add_producers(coordinator.farm(), call->id(), map);
    add_leases(coordinator.farm(), call->id(), map);
  } else if (auto added = add_stored_samples(coordinator.store(), call->id(), map); !added) {
    return core::fail(added.error());
  }
  if (auto added = add_noise(call->context.tiles, call->id(), map); !added) return core::fail(added.error());
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
  body += ",\"tiles\":[" + tiles_text(map) + "]}\n";
  http::Response response = json_response(Json::object());
  response.body = std::move(body);
  return response;
}

}  // namespace tessera::http_api
