// SPDX-License-Identifier: Apache-2.0
// What the scheduler speaks of: ids, times, pieces of work. Plain values, no behaviour.
#pragma once

#include <chrono>
#include <compare>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/film/region.hpp"

namespace tessera::scheduler {

// The scheduler never reads a clock; it is told the time. Only differences matter.
using Time = std::chrono::steady_clock::time_point;
using Duration = std::chrono::steady_clock::duration;

template <typename Tag>
struct TextId {
  std::string value;
  auto operator<=>(const TextId&) const = default;
};
using JobId = TextId<struct JobTag>;
using WorkerId = TextId<struct WorkerTag>;

inline constexpr int kLeaseCounterBits = 40;

// The coordinator's epoch in the upper 24 bits, a counter from 1 in the lower 40: never used twice.
struct LeaseId {
  std::uint64_t value = 0;
  auto operator<=>(const LeaseId&) const = default;
};

// What must be rendered of a job: samples [0, spp) of every pixel of a window of a picture, cut into tiles.
struct JobShape {
  core::PixelRect window;
  std::uint32_t spp = 0;

  constexpr JobShape() = default;
  constexpr JobShape(core::PixelRect of_picture, std::uint32_t samples) : window(of_picture), spp(samples) {}
  // A whole picture.
  constexpr JobShape(int width_px, int height_px, std::uint32_t samples)
      : JobShape({0, 0, width_px, height_px}, samples) {}

  core::TileGrid grid() const { return {window, core::kTilePx}; }
  bool operator==(const JobShape&) const = default;
};

// The unit of work: samples of one tile of the job's grid.
struct WorkItem {
  int tile = 0;
  core::SampleRange samples;
  bool operator==(const WorkItem&) const = default;
};

// Stands in WorkItem::tile for a rectangle that is no tile of the grid. Results with it are refused.
inline constexpr int kNoTile = -1;

// The tile whose rectangle this is, or kNoTile.
inline int tile_index(const core::TileGrid& grid, const core::PixelRect& rect) {
  if (rect.empty() || !grid.window().contains(rect)) return kNoTile;
  const int tile = grid.tile_at(rect.x0, rect.y0);
  return grid.rect(tile) == rect ? tile : kNoTile;
}

// Proves that this farm has given a lease to a worker: whoever does not know the farm's secret cannot make
// one.
using LeaseToken = std::string;

// Makes the token of a lease. A pure function of its arguments and the farm's secret, the same in every run
// of the coordinator.
using SignLease = std::function<LeaseToken(LeaseId lease, const WorkerId& holder, const JobId& job)>;

// Work that one worker has been asked to do, as both sides of the wire know it.
struct LeaseDescription {
  LeaseId id;
  JobId job;
  std::vector<WorkItem> items;
  LeaseToken token{};
  bool operator==(const LeaseDescription&) const = default;
};

inline constexpr std::size_t kMaxItemsPerLease = 32;
inline constexpr int kMaxLeasesPerWorker = 4;

}  // namespace tessera::scheduler
