#include "tests/simulation/model_film.hpp"

#include <algorithm>

namespace tessera::simulation {

ModelFilm::ModelFilm(const scheduler::JobShape& shape)
    : tiles_(static_cast<std::size_t>(shape.grid().tile_count()), std::vector<bool>(shape.spp)) {}

void ModelFilm::extend(std::uint32_t spp) {
  for (std::vector<bool>& tile : tiles_) tile.resize(spp);
}

bool ModelFilm::add(const scheduler::WorkItem& item) {
  if (item.tile < 0 || item.tile >= tile_count()) return false;
  std::vector<bool>& tile = tiles_[static_cast<std::size_t>(item.tile)];
  if (item.samples.empty() || item.samples.end > tile.size()) return false;
  for (std::uint32_t s = item.samples.begin; s < item.samples.end; ++s) {
    if (tile[s]) return false;
    tile[s] = true;
  }
  return true;
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

}  // namespace tessera::simulation
