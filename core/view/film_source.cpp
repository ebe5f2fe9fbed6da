// SPDX-License-Identifier: Apache-2.0
#include "core/view/film_source.hpp"

#include <utility>

namespace tessera::view {

FilmSource::FilmSource(std::string id, const core::TileGrid& grid, std::function<JobHeader()> describe)
    : id_(std::move(id)),
      grid_(grid),
      describe_(std::move(describe)),
      revisions_(static_cast<std::size_t>(grid.tile_count())) {}

void FilmSource::attach(const core::Film& film) {
  std::vector<int> tiles;
  {
    const std::lock_guard lock(film_mutex_);
    film_ = &film;
    layers_ = film.layers();
    for (int tile = 0; tile < grid_.tile_count(); ++tile)
      if (film.samples(tile) > 0) tiles.push_back(tile);
  }
  const std::lock_guard lock(mutex_);
  for (const int tile : tiles)
    if (revisions_[static_cast<std::size_t>(tile)] == 0) note_tile(tile);
}

void FilmSource::detach() {
  const std::lock_guard lock(film_mutex_);
  film_ = nullptr;
}

core::LayerSet FilmSource::layers() {
  const std::lock_guard lock(film_mutex_);
  return layers_;
}

void FilmSource::note_tile(int tile) {
  Revision& revision = revisions_[static_cast<std::size_t>(tile)];
  if (revision > 0) log_.erase(revision);
  revision = ++last_;
  log_.emplace(revision, tile);
}

void FilmSource::note_change(const core::PixelRect& rect) {
  const std::lock_guard lock(mutex_);
  for (int y = rect.y0; y < rect.y1; y += grid_.tile_px())
    for (int x = rect.x0; x < rect.x1; x += grid_.tile_px()) note_tile(grid_.tile_at(x, y));
}

void FilmSource::end() {
  const std::lock_guard lock(mutex_);
  is_over_ = true;
}

core::Result<std::vector<TileChange>> FilmSource::changes_since(Revision since, std::size_t most) {
  const std::lock_guard lock(mutex_);
  std::vector<TileChange> changes;
  for (auto entry = log_.upper_bound(since); entry != log_.end() && changes.size() < most; ++entry)
    changes.push_back({entry->first, entry->second});
  return changes;
}

// The revision is taken before the samples, which may be newer.
core::Result<TileAtRevision> FilmSource::read(const TileChange& change) {
  TileAtRevision tile;
  {
    const std::lock_guard lock(mutex_);
    tile.revision = revisions_[static_cast<std::size_t>(change.tile)];
  }
  const std::lock_guard lock(film_mutex_);
  if (film_ == nullptr)
    return core::fail(core::ErrorCode::kUnavailable, "the image cannot be read at the moment; try again");
  tile.sums = film_->tile(change.tile);
  tile.layers = layers_;
  return tile;
}

bool FilmSource::is_over() {
  const std::lock_guard lock(mutex_);
  return is_over_;
}

}  // namespace tessera::view
