// SPDX-License-Identifier: Apache-2.0
#include "tests/simulation/model_film.hpp"

#include <algorithm>

namespace tessera::simulation {
namespace {

std::size_t target_of(const scheduler::JobShape& shape, int tile) {
  const auto& exceptions = shape.targets.all();
  const auto found = std::find_if(exceptions.begin(), exceptions.end(),
                                  [tile](const scheduler::TileTarget& each) { return each.tile == tile; });
  return found == exceptions.end() ? shape.spp : found->spp;
}

}  // namespace

ModelFilm::ModelFilm(const scheduler::JobShape& shape) {
  const core::TileGrid grid(shape.window, core::kTilePx);
  for (int image = 0; image < shape.images; ++image) {
    for (int tile = 0; tile < grid.tile_count(); ++tile)
      tile_pixels_.push_back(static_cast<double>(grid.rect(tile).pixel_count()));
  }
  tiles_.resize(tile_pixels_.size());
  set_targets(shape);
}

void ModelFilm::extend(std::uint32_t spp, const std::vector<scheduler::TileTarget>& tiles) {
  for (std::vector<bool>& tile : tiles_) tile.resize(std::max<std::size_t>(spp, tile.size()));
  for (const scheduler::TileTarget& each : tiles) {
    std::vector<bool>& tile = tiles_.at(static_cast<std::size_t>(each.tile));
    tile.resize(std::max<std::size_t>(each.spp, tile.size()));
  }
}

void ModelFilm::extend(const scheduler::JobShape& shape) {
  for (int tile = 0; tile < tile_count(); ++tile) {
    std::vector<bool>& samples = tiles_[static_cast<std::size_t>(tile)];
    samples.resize(std::max<std::size_t>(target_of(shape, tile), samples.size()));
  }
}

void ModelFilm::set_targets(const scheduler::JobShape& shape) {
  for (int tile = 0; tile < tile_count(); ++tile)
    tiles_[static_cast<std::size_t>(tile)].resize(target_of(shape, tile));
}

bool ModelFilm::fits(const scheduler::WorkItem& item) const {
  return item.tile >= 0 && item.tile < tile_count() && !item.samples.empty() &&
         item.samples.end <= tiles_[static_cast<std::size_t>(item.tile)].size();
}

bool ModelFilm::add(const scheduler::WorkItem& item) {
  if (!fits(item) || has_any(item)) return false;
  std::vector<bool>& tile = tiles_[static_cast<std::size_t>(item.tile)];
  std::fill(tile.begin() + item.samples.begin, tile.begin() + item.samples.end, true);
  return true;
}

void ModelFilm::clear(int tile) {
  std::vector<bool>& samples = tiles_[static_cast<std::size_t>(tile)];
  samples.assign(samples.size(), false);
  spoilt_.erase(tile);
}

bool ModelFilm::has(const scheduler::WorkItem& item) const {
  if (!fits(item)) return false;
  const std::vector<bool>& tile = tiles_[static_cast<std::size_t>(item.tile)];
  const auto end = tile.begin() + item.samples.end;
  return std::find(tile.begin() + item.samples.begin, end, false) == end;
}

bool ModelFilm::has_any(const scheduler::WorkItem& item) const {
  if (!fits(item)) return false;
  const std::vector<bool>& tile = tiles_[static_cast<std::size_t>(item.tile)];
  const auto end = tile.begin() + item.samples.end;
  return std::find(tile.begin() + item.samples.begin, end, true) != end;
}

bool ModelFilm::complete() const {
  return std::all_of(tiles_.begin(), tiles_.end(), [](const std::vector<bool>& tile) {
    return std::find(tile.begin(), tile.end(), false) == tile.end();
  });
}

scheduler::IntervalSet ModelFilm::done(int tile) const {
  scheduler::IntervalSet set;
  const std::vector<bool>& samples = tiles_[static_cast<std::size_t>(tile)];
  for (std::uint32_t s = 0; s < samples.size(); ++s) {
    if (samples[s]) set.add({s, s + 1});
  }
  return set;
}

std::uint64_t ModelFilm::count(int tile) const {
  const std::vector<bool>& samples = tiles_[static_cast<std::size_t>(tile)];
  return static_cast<std::uint64_t>(std::count(samples.begin(), samples.end(), true));
}

void ModelFilm::copy_tile(int tile, const ModelFilm& from) {
  tiles_[static_cast<std::size_t>(tile)] = from.tiles_[static_cast<std::size_t>(tile)];
  spoilt_.erase(tile);
  if (const auto found = from.spoilt_.find(tile); found != from.spoilt_.end()) spoilt_.insert(*found);
}

}  // namespace tessera::simulation
