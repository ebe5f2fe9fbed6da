// SPDX-License-Identifier: Apache-2.0
#include "client/work_cutter.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace tessera::client {

using core::PixelRect;

namespace {

// Enough pixels for many threads. A piece with as many takes further samples before further pixels.
constexpr std::uint64_t kUsualPixels = 16 * core::kTilePx * core::kTilePx;

std::size_t index(int tile) {
  return static_cast<std::size_t>(tile);
}

}  // namespace

WorkCutter::WorkCutter(core::TileGrid grid, std::uint32_t spp, std::vector<std::uint32_t> samples)
    : grid_(grid), spp_(spp), samples_(std::move(samples)) {
  assert(samples_.size() == index(grid.tile_count()));
  begin_pass();
}

std::optional<WorkPiece> WorkCutter::next(std::uint64_t target_samples) {
  if (!find_tile()) {
    begin_pass();
    if (!find_tile()) return std::nullopt;
  }
  const std::uint32_t begin = samples_[index(tile_)], left = pass_end_ - begin;
  const PixelRect rect = widen(std::min(target_samples, std::max(target_samples / left, kUsualPixels)));
  const std::uint64_t wanted = std::max<std::uint64_t>(target_samples / rect.pixel_count(), 1);
  const auto count = static_cast<std::uint32_t>(std::min<std::uint64_t>(wanted, left));
  for (int y = rect.y0; y < rect.y1; y += grid_.tile_px())
    for (int x = rect.x0; x < rect.x1; x += grid_.tile_px()) samples_[index(grid_.tile_at(x, y))] += count;
  tile_ = grid_.tile_at(rect.x1 - 1, rect.y1 - 1) + 1;
  return WorkPiece{rect, {begin, begin + count}};
}

// Goes to the next tile that lacks samples of this pass, behind the end again from the first on.
bool WorkCutter::find_tile() {
  const auto lacks = [this](std::uint32_t samples) { return samples < pass_end_; };
  auto found = std::find_if(samples_.begin() + tile_, samples_.end(), lacks);
  if (found == samples_.end()) found = std::find_if(samples_.begin(), samples_.end(), lacks);
  if (found == samples_.end()) return false;
  tile_ = static_cast<int>(found - samples_.begin());
  return true;
}

void WorkCutter::begin_pass() {
  const std::uint32_t least = *std::min_element(samples_.begin(), samples_.end());
  pass_end_ = std::min(spp_, least + std::clamp(least, 1u, kMaxPassSamples));
  tile_ = 0;
}

// The rectangle that begins with tile_, whose tiles have equally many samples, of at most so many pixels: a
// run of tiles, or whole rows of them.
PixelRect WorkCutter::widen(std::uint64_t pixels) const {
  pixels = std::min<std::uint64_t>(pixels, kMaxPiecePixels);
  PixelRect rect = grid_.rect(tile_);
  const int column = tile_ % grid_.columns(), row = tile_ / grid_.columns();
  for (int tile = tile_ + 1; tile % grid_.columns() != 0 && extends(tile); ++tile) {
    const PixelRect next = grid_.rect(tile);
    if (rect.pixel_count() + next.pixel_count() > pixels) return rect;
    rect.x1 = next.x1;
  }
  if (column != 0 || rect.x1 != grid_.window().x1) return rect;
  for (int below = row + 1; below < grid_.rows() && row_extends(below); ++below) {
    const PixelRect next{rect.x0, rect.y1, rect.x1, grid_.rect(below * grid_.columns()).y1};
    if (rect.pixel_count() + next.pixel_count() > pixels) return rect;
    rect.y1 = next.y1;
  }
  return rect;
}

bool WorkCutter::extends(int tile) const {
  return samples_[index(tile)] == samples_[index(tile_)];
}

bool WorkCutter::row_extends(int row) const {
  const auto begin = samples_.begin() + row * grid_.columns();
  return std::all_of(begin, begin + grid_.columns(),
                     [this](std::uint32_t samples) { return samples == samples_[index(tile_)]; });
}

}  // namespace tessera::client
