// SPDX-License-Identifier: Apache-2.0
#include "server/jobs/film_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "core/film/layout.hpp"
#include "server/film/stored_tile.hpp"

namespace tessera::jobs {

using core::ErrorCode;
using film::TilePart;
using scheduler::IntervalSet;

namespace {

// The store changes a tile once a second at most, so that a second attempt is rare.
constexpr int kAttempts = 100;

IntervalSet set_of(const std::vector<core::SampleRange>& ranges) {
  IntervalSet set;
  for (const core::SampleRange& range : ranges) set.add(range);
  return set;
}

core::Film::TileSums zeros(const core::PixelRect& rect) {
  const std::size_t sums = core::rgb_layout().sums(rect.pixel_count());
  return {std::vector<std::uint64_t>(sums), std::vector<std::uint64_t>(sums), 0, 0, {}};
}

}  // namespace

bool FilmReader::can_be_verified(film::Produced& provenance) const {
  if (provenance.fingerprinter == fingerprinter_.check()) return true;
  const bool due = std::any_of(provenance.items.begin(), provenance.items.end(),
                               [](const auto& each) { return each.due != scheduler::Due::kNo; });
  provenance.items.clear();
  return !due;
}

core::Result<LoadedFilm> FilmReader::load(const v1::Job& spec) const {
  const scheduler::JobGrid grid = farm::grid_of(spec);
  auto done = store_.tiles_done(spec.id());
  if (!done) return core::fail(done.error());
  const auto revisions = revisions_of(spec.id());
  if (!revisions) return core::fail(revisions.error());
  LoadedFilm loaded{film::JobFilm::make(grid, memory_, revisions_, farm::layers_of(spec)), {}, {}, {}};
  for (const auto& [tile, ranges] : *done) {
    if (tile < 0 || tile >= grid.tile_count()) continue;
    const auto known = revisions->find(tile);
    const store::TileChange change{known == revisions->end() ? revisions_.next() : known->second, tile};
    if (auto read = load_tile(loaded, spec, change, ranges); !read) return core::fail(read.error());
  }
  return loaded;
}

core::Result<std::map<int, events::Revision>> FilmReader::revisions_of(const std::string& job_id) const {
  const auto changes = store_.tile_changes(job_id, 0, std::numeric_limits<std::size_t>::max());
  if (!changes) return core::fail(changes.error());
  std::map<int, events::Revision> revisions;
  for (const store::TileChange& change : *changes) revisions[change.tile] = change.revision;
  return revisions;
}

core::Status FilmReader::load_tile(LoadedFilm& loaded, const v1::Job& spec, const store::TileChange& change,
                                   const std::vector<core::SampleRange>& done) const {
  const int tile = change.tile;
  auto stored = film::read_stored_tile(store_, spec.id(), loaded.film->grid(), tile, loaded.film->layers());
  if (!stored) {
    if (stored.error().code != ErrorCode::kDataLoss) return core::fail(stored.error());
    loaded.damage.push_back(stored.error().message);
    return {};
  }
  film::TileContent& content = stored->content;
  if (!can_be_verified(content.provenance)) {
    loaded.damage.push_back(
        fmt::format("tile {} of job {} was to be verified, and its fingerprints are of another state folder",
                    tile, spec.id()));
    return {};
  }
  auto& items = content.provenance.items;
  loaded.provenance.insert(loaded.provenance.end(), items.begin(), items.end());
  loaded.film->note_producers(items);
  loaded.film->restore(tile, set_of(stored->row.done), content.counters, change.revision);
  loaded.done[tile] = done;  // the ranges that were written
  return {};
}

core::Result<core::Film::TileSums> FilmReader::stored_sums(const v1::Job& spec, int tile) const {
  const scheduler::JobGrid grid = farm::grid_of(spec);
  auto stored = film::read_stored_tile(store_, spec.id(), grid, tile, farm::layers_of(spec));
  if (stored && stored->content.sums.samples > 0) return std::move(stored->content.sums);
  if (!stored && stored.error().code != ErrorCode::kNotFound) return core::fail(stored.error());
  return zeros(grid.rect(tile));
}

core::Result<core::Film::TileSums> FilmReader::sums(const v1::Job& spec, const film::JobFilm& film, int tile,
                                                    events::Revision* revision) const {
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    const film::TileSnapshot parts = film.snapshot(tile);
    if (revision != nullptr) *revision = parts.revision;
    if (parts.stored.empty() && !parts.storing && !parts.newest) return zeros(film.grid().rect(tile));
    // Nothing is added to a part while it is shared, so a tile in memory as a whole is not copied.
    if (parts.stored.empty() && !parts.storing) return parts.newest->sums();
    const auto all = combine(spec, tile, parts);
    if (!all) return core::fail(all.error());
    if (*all) return (*all)->sums();
  }
  return core::fail(ErrorCode::kUnavailable, fmt::format("tile {} changes too often: try again", tile));
}

core::Result<std::shared_ptr<TilePart>> FilmReader::combine(const v1::Job& spec, int tile,
                                                            const film::TileSnapshot& parts) const {
  const scheduler::JobGrid grid = farm::grid_of(spec);
  const core::LayerSet layers = farm::layers_of(spec);
  auto all = std::make_shared<TilePart>(std::make_shared<const core::FilmLayout>(core::film_layout(layers)),
                                        grid.rect(tile), memory_);
  IntervalSet in_store = parts.stored;
  if (!parts.stored.empty()) {
    auto stored = film::read_stored_tile(store_, spec.id(), grid, tile, layers);
    if (!stored) return core::fail(stored.error());
    const IntervalSet read = set_of(stored->row.done);
    IntervalSet with_storing = parts.stored;
    if (parts.storing) with_storing.add(parts.storing->samples());
    if (read != parts.stored && read != with_storing) return std::shared_ptr<TilePart>();
    all->add(stored->content.sums, read, stored->content.counters);
  }
  // If the part that is being stored has arrived in the store, it was read with the rest.
  const bool has_storing =
      parts.storing && all->samples().contains(parts.storing->samples().ranges().front());
  if (parts.storing && !has_storing) all->add(*parts.storing);
  if (parts.newest) all->add(*parts.newest);
  return all;
}

core::Result<std::shared_ptr<TilePart>> FilmReader::whole(const v1::Job& spec, int tile,
                                                          const film::TileToStore& to_store) const {
  auto all = combine(spec, tile, to_store.parts);
  if (!all && all.error().code == ErrorCode::kNotFound)
    return core::fail(ErrorCode::kDataLoss, all.error().message);
  if (all && !*all)
    return core::fail(
        ErrorCode::kDataLoss,
        fmt::format("the stored tile {} of job {} has other samples than were stored", tile, spec.id()));
  return all;
}

}  // namespace tessera::jobs
