// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/job_shape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace tessera::scheduler {
namespace {

// The pixel samples of these tiles beyond (or below) those of as many tiles without targets of their own.
std::int64_t excess(const JobShape& shape, TileTargets::ByTile::const_iterator first,
                    TileTargets::ByTile::const_iterator last) {
  const JobGrid grid = shape.grid();
  std::int64_t samples = 0;
  for (; first != last; ++first) {
    const std::int64_t more = std::int64_t{first->spp} - std::int64_t{shape.spp};
    samples += more * static_cast<std::int64_t>(grid.rect(first->tile).pixel_count());
  }
  return samples;
}

// Of each tile in a list in order, only the highest target.
void keep_highest(TileTargets::ByTile& targets) {
  const auto of_one_tile = [](const TileTarget& a, const TileTarget& b) { return a.tile == b.tile; };
  targets.erase(targets.begin(), std::unique(targets.rbegin(), targets.rend(), of_one_tile).base());
}

TileTargets::ByTile highest_of(const TileTargets::ByTile& a, const TileTargets::ByTile& b) {
  TileTargets::ByTile both;
  both.reserve(a.size() + b.size());
  std::merge(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both));
  keep_highest(both);
  return both;
}

// Where the targets of this tile and later ones begin.
TileTargets::ByTile::const_iterator from_tile(const TileTargets::ByTile& targets, int tile) {
  return std::lower_bound(targets.begin(), targets.end(), tile,
                          [](const TileTarget& each, int wanted) { return each.tile < wanted; });
}

}  // namespace

TileTargets::TileTargets(ByTile targets) {
  if (targets.empty()) return;
  if (!std::is_sorted(targets.begin(), targets.end())) std::sort(targets.begin(), targets.end());
  keep_highest(targets);
  targets_ = std::make_shared<const ByTile>(std::move(targets));
}

const TileTarget* TileTargets::find(int tile) const {
  const auto found = from_tile(all(), tile);
  return found == all().end() || found->tile != tile ? nullptr : &*found;
}

std::uint64_t JobShape::pixel_samples() const {
  const std::uint64_t images_pixels = window.pixel_count() * static_cast<std::uint64_t>(images);
  const auto& all = targets.all();
  return images_pixels * spp + static_cast<std::uint64_t>(excess(*this, all.begin(), all.end()));
}

std::uint64_t JobShape::pixel_samples_of(int image) const {
  const auto& all = targets.all();
  if (all.empty()) return window.pixel_count() * std::uint64_t{spp};
  const JobGrid tiles = grid();
  const auto first = from_tile(all, tiles.first_tile(image));
  const auto last = from_tile(all, tiles.first_tile(image + 1));
  return window.pixel_count() * std::uint64_t{spp} + static_cast<std::uint64_t>(excess(*this, first, last));
}

bool JobShape::is_raised_by(std::uint32_t to_spp, const std::vector<TileTarget>& tiles) const {
  const auto& all = targets.all();
  return to_spp > spp ||
         std::any_of(all.begin(), all.end(), [&](const TileTarget& each) { return each.spp < to_spp; }) ||
         std::any_of(tiles.begin(), tiles.end(),
                     [&](const TileTarget& each) { return each.spp > target(each.tile); });
}

std::uint64_t JobShape::raise(std::uint32_t to_spp, const std::vector<TileTarget>& tiles) {
  const JobShape before = *this;
  TileTargets::ByTile asked;
  for (const TileTarget& each : tiles)
    if (each.spp > target(each.tile)) asked.push_back(each);
  const TileTargets higher(std::move(asked));
  TileTargets::ByTile raised = highest_of(targets.all(), higher.all());
  spp = std::max(spp, to_spp);
  std::erase_if(raised, [&](const TileTarget& each) { return each.spp == spp || each.spp < to_spp; });
  targets = TileTargets(std::move(raised));
  if (to_spp > 0) return pixel_samples() - before.pixel_samples();
  std::uint64_t added = 0;
  for (const TileTarget& each : higher.all())
    added += grid().rect(each.tile).pixel_count() * std::uint64_t{each.spp - before.target(each.tile)};
  return added;
}

core::Status check_shape(const JobShape& shape) {
  if (shape.window.empty() || shape.images < 1 || shape.spp == 0) {
    return core::fail(
        core::ErrorCode::kInvalidArgument,
        fmt::format("a job of {} images of {}x{} pixels and {} samples per pixel has nothing to render",
                    shape.images, shape.window.width(), shape.window.height(), shape.spp));
  }
  const JobGrid grid = shape.grid();
  if (grid.tiles_per_image() > kMaxTilesPerJob / shape.images)
    return core::fail(core::ErrorCode::kInvalidArgument,
                      fmt::format("a job of {} images of {} tiles each is too large: {} tiles at most",
                                  shape.images, grid.tiles_per_image(), kMaxTilesPerJob));
  if (shape.targets.all().size() > kMaxTileTargets)
    return core::fail(core::ErrorCode::kInvalidArgument,
                      fmt::format("a job can have {} tiles with targets of their own", kMaxTileTargets));
  for (const auto& [tile, target] : shape.targets.all()) {
    if (tile >= 0 && tile < grid.tile_count() && target > 0) continue;
    return core::fail(core::ErrorCode::kInvalidArgument,
                      fmt::format("a target of {} samples of tile {}, of {} tiles, is impossible", target,
                                  tile, grid.tile_count()));
  }
  return {};
}

}  // namespace tessera::scheduler
