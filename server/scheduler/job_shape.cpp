// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/job_shape.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace tessera::scheduler {
namespace {

// The pixel samples of these tiles beyond (or below) those of as many tiles without targets of their own.
std::int64_t excess(const JobShape& shape, TileTargets::ByTile::const_iterator first,
                    TileTargets::ByTile::const_iterator last) {
  const JobGrid grid = shape.grid();
  std::int64_t samples = 0;
  for (; first != last; ++first) {
    const std::int64_t more = std::int64_t{first->second} - std::int64_t{shape.spp};
    samples += more * static_cast<std::int64_t>(grid.rect(first->first).pixel_count());
  }
  return samples;
}

}  // namespace

std::uint64_t JobShape::pixel_samples() const {
  const std::uint64_t images_pixels = window.pixel_count() * static_cast<std::uint64_t>(images);
  const auto& all = targets.all();
  return images_pixels * spp + static_cast<std::uint64_t>(excess(*this, all.begin(), all.end()));
}

std::uint64_t JobShape::pixel_samples_of(int image) const {
  const auto& all = targets.all();
  if (all.empty()) return window.pixel_count() * std::uint64_t{spp};
  const JobGrid tiles = grid();
  const auto first = all.lower_bound(tiles.first_tile(image));
  const auto last = all.lower_bound(tiles.first_tile(image + 1));
  return window.pixel_count() * std::uint64_t{spp} + static_cast<std::uint64_t>(excess(*this, first, last));
}

bool JobShape::is_raised_by(std::uint32_t to_spp, const std::vector<TileTarget>& tiles) const {
  const auto& all = targets.all();
  return to_spp > spp ||
         std::any_of(all.begin(), all.end(), [&](const auto& each) { return each.second < to_spp; }) ||
         std::any_of(tiles.begin(), tiles.end(),
                     [&](const TileTarget& each) { return each.spp > target(each.tile); });
}

void JobShape::raise(std::uint32_t to_spp, const std::vector<TileTarget>& tiles) {
  TileTargets::ByTile raised = targets.all();
  for (const TileTarget& each : tiles) {
    std::uint32_t& target = raised.try_emplace(each.tile, spp).first->second;
    target = std::max(target, each.spp);
  }
  spp = std::max(spp, to_spp);
  std::erase_if(raised, [&](const auto& each) { return each.second == spp || each.second < to_spp; });
  targets = TileTargets(std::move(raised));
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
