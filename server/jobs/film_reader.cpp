// SPDX-License-Identifier: Apache-2.0
#include "server/jobs/film_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "server/film/stored_tile.hpp"

namespace tessera::jobs {

using core::ErrorCode;

bool FilmReader::can_be_verified(film::Produced& provenance) const {
  if (provenance.fingerprinter == fingerprinter_.check()) return true;
  const bool due = std::any_of(provenance.items.begin(), provenance.items.end(),
                               [](const auto& each) { return each.due != scheduler::Due::kNo; });
  provenance.items.clear();
  return !due;
}

core::Result<LoadedFilm> FilmReader::load(const v1::Job& spec) const {
  const core::TileGrid grid = farm::grid_of(spec);
  auto done = store_.tiles_done(spec.id());
  if (!done) return core::fail(done.error());
  LoadedFilm loaded{std::make_unique<film::JobFilm>(grid), {}, {}, {}};
  for (const auto& [tile, ranges] : *done) {
    if (tile < 0 || tile >= grid.tile_count()) continue;
    if (auto read = load_tile_into(loaded, spec, grid, tile, ranges); !read) return core::fail(read.error());
  }
  return loaded;
}

core::Status FilmReader::load_tile_into(LoadedFilm& loaded, const v1::Job& spec, const core::TileGrid& grid,
                                        int tile, const std::vector<core::SampleRange>& done) const {
  auto content = load_tile(spec, grid, tile);
  if (!content) {
    if (content.error().code != ErrorCode::kDataLoss) return core::fail(content.error());
    loaded.damage.push_back(content.error().message);
    return {};
  }
  if (!can_be_verified(content->provenance)) {
    loaded.damage.push_back(
        fmt::format("tile {} of job {} was to be verified, and its fingerprints are of another state folder",
                    tile, spec.id()));
    return {};
  }
  auto& items = content->provenance.items;
  loaded.provenance.insert(loaded.provenance.end(), items.begin(), items.end());
  loaded.film->restore(tile, *content);
  loaded.done[tile] = done;  // the ranges that were written
  return {};
}

core::Result<film::TileContent> FilmReader::load_tile(const v1::Job& spec, const core::TileGrid& grid,
                                                      int tile) const {
  auto stored = film::read_stored_tile(store_, spec.id(), grid, tile);
  if (stored) return std::move(stored->content);
  if (stored.error().code != ErrorCode::kNotFound) return core::fail(stored.error());
  const std::size_t channels = grid.rect(tile).pixel_count() * 3;
  return film::TileContent{
      {std::vector<std::uint64_t>(channels), std::vector<std::uint64_t>(channels), 0, 0}, {}, {}};
}

}  // namespace tessera::jobs
