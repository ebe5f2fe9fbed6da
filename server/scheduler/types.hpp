// SPDX-License-Identifier: Apache-2.0
// The scheduler's basic types: ids, times, work items. Plain values.
#pragma once

#include <chrono>
#include <compare>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/film/region.hpp"

namespace tessera::scheduler {

// The scheduler never reads a clock; times are arguments. Only differences matter.
using Time = std::chrono::steady_clock::time_point;
using Duration = std::chrono::steady_clock::duration;

template <typename Tag>
struct TextId {
  std::string value;
  auto operator<=>(const TextId&) const = default;
};
using JobId = TextId<struct JobTag>;
using WorkerId = TextId<struct WorkerTag>;

// Numbers jobs in the order of submission. Never reused.
using JobNumber = std::uint64_t;
// Numbers the runs of jobs. A run ends when its job is done, cancelled, failed or deleted. Never reused.
using RunNumber = std::uint64_t;

inline constexpr int kLeaseCounterBits = 40;

// The coordinator's epoch in the upper 24 bits, a counter from 1 in the lower 40. Never reused.
struct LeaseId {
  std::uint64_t value = 0;
  auto operator<=>(const LeaseId&) const = default;
};

struct LeaseIdHash {
  std::size_t operator()(LeaseId id) const { return std::hash<std::uint64_t>{}(id.value); }
};

// The work of a job: samples [0, spp) of every pixel of a window of an image, divided into tiles.
struct JobShape {
  core::PixelRect window;
  std::uint32_t spp = 0;

  constexpr JobShape() = default;
  constexpr JobShape(core::PixelRect of_picture, std::uint32_t samples) : window(of_picture), spp(samples) {}
  // The whole image.
  constexpr JobShape(int width_px, int height_px, std::uint32_t samples)
      : JobShape({0, 0, width_px, height_px}, samples) {}

  core::TileGrid grid() const { return {window, core::kTilePx}; }
  bool operator==(const JobShape&) const = default;
};

// The unit of work: a range of samples of one tile of the job's grid.
struct WorkItem {
  int tile = 0;
  core::SampleRange samples;
  bool operator==(const WorkItem&) const = default;
};

// The tile of a WorkItem whose rectangle is no tile of the grid. Results with it are refused.
inline constexpr int kNoTile = -1;

// The index of the tile with this rectangle, or kNoTile.
inline int tile_index(const core::TileGrid& grid, const core::PixelRect& rect) {
  if (rect.empty() || !grid.window().contains(rect)) return kNoTile;
  const int tile = grid.tile_at(rect.x0, rect.y0);
  return grid.rect(tile) == rect ? tile : kNoTile;
}

// Proves that this farm granted a lease to a worker. It cannot be made without the farm's secret.
using LeaseToken = std::string;

// Makes the token of a lease. A pure function of its arguments and the farm's secret, equal in every run of
// the coordinator.
using SignLease = std::function<LeaseToken(LeaseId lease, const WorkerId& holder, const JobId& job)>;

// A lease as both sides of the protocol know it.
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
