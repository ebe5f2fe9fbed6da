// SPDX-License-Identifier: Apache-2.0
#include "client/shared_film.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace tessera::client {

using TileSums = core::Film::TileSums;

void RenderTotals::add(const RenderTotals& other) {
  counters.add(other.counters);
  seconds += other.seconds;
  core_seconds += other.core_seconds;
}

RenderTotals SharedFilm::totals() const {
  const std::lock_guard lock(mutex_);
  return totals_;
}

void SharedFilm::add(const core::FilmTile& tile, const RenderTotals& work,
                     const std::vector<RenderObserver*>& observers) {
  {
    std::vector<std::unique_lock<std::mutex>> readers;
    for (RenderObserver* observer : observers) readers.emplace_back(observer->film_mutex());
    const std::lock_guard lock(mutex_);
    if (frozen_) copy_before_change(tile.rect);
    film_.add(tile);
    totals_.add(work);
  }
  for (RenderObserver* observer : observers) observer->samples_added(tile.rect, tile.range);
}

TileSums SharedFilm::tile(int index) const {
  const std::lock_guard lock(mutex_);
  return film_.tile(index);
}

std::vector<std::uint32_t> SharedFilm::samples() const {
  const std::lock_guard lock(mutex_);
  return samples_of_tiles(film_);
}

core::Image SharedFilm::develop() const {
  const core::TileGrid& grid = film_.grid();
  core::Image image(grid.width(), grid.height());
  for (int index = 0; index < grid.tile_count(); ++index) {
    const core::PixelRect rect = grid.rect(index);
    const core::Image part = core::develop_tile(rect, tile(index));
    for (int y = 0; y < part.height; ++y)
      std::copy_n(&part.at(0, y), part.width,
                  &image.at(rect.x0 - grid.window().x0, rect.y0 - grid.window().y0 + y));
  }
  return image;
}

void SharedFilm::copy_before_change(const core::PixelRect& rect) {
  const core::TileGrid& grid = film_.grid();
  for (int y = rect.y0; y < rect.y1; y += grid.tile_px()) {
    for (int x = rect.x0; x < rect.x1; x += grid.tile_px()) {
      const int index = grid.tile_at(x, y);
      if (frozen_->taken[static_cast<std::size_t>(index)] || frozen_->copies.contains(index)) continue;
      frozen_->copies.emplace(index, film_.tile(index));
    }
  }
}

SharedFilm::Snapshot::Snapshot(SharedFilm& film) : film_(film) {
  const std::lock_guard lock(film_.mutex_);
  assert(!film_.frozen_);
  totals_ = film_.totals_;
  film_.frozen_.emplace().taken.resize(static_cast<std::size_t>(film_.grid().tile_count()));
}

SharedFilm::Snapshot::~Snapshot() {
  const std::lock_guard lock(film_.mutex_);
  film_.frozen_.reset();
}

TileSums SharedFilm::Snapshot::take(int index) {
  const std::lock_guard lock(film_.mutex_);
  film_.frozen_->taken[static_cast<std::size_t>(index)] = true;
  const auto copy = film_.frozen_->copies.extract(index);
  return copy ? std::move(copy.mapped()) : film_.film_.tile(index);
}

std::vector<std::uint32_t> samples_of_tiles(const core::Film& film) {
  std::vector<std::uint32_t> samples;
  for (int tile = 0; tile < film.grid().tile_count(); ++tile) samples.push_back(film.samples(tile));
  return samples;
}

}  // namespace tessera::client
