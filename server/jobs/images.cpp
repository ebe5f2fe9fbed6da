// SPDX-License-Identifier: Apache-2.0
// Develops the image of a job, finished or not.
#include <fmt/format.h>
#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "server/jobs/images.hpp"

namespace tessera::jobs {

namespace {

// The tiles that are copied at once under the state lock, which takes about a millisecond.
constexpr int kTilesPerTurn = 8;

core::Error with_advice(core::Error error, v1::JobState state) {
  if (error.code != core::ErrorCode::kDataLoss) return error;
  error.message += state == v1::JOB_STATE_CANCELLED || state == v1::JOB_STATE_FAILED
                       ? ": it is lost, since the job is not rendered any more: submit the scene again"
                       : ": submit the scene again; or stop the coordinator and run it once with --salvage, "
                         "after which the tile is rendered again";
  return error;
}

}  // namespace

core::Result<v1::Job> Images::describe(const std::string& id) {
  const auto found = [&]() -> std::optional<farm::JobSnapshot> {
    const farm::StateLock lock(farm_);
    const farm::JobRecord* record = lock->find_job(id);
    if (record == nullptr) return std::nullopt;
    return lock.snapshot_of(*record);
  }();
  if (!found) return core::fail(core::ErrorCode::kNotFound, fmt::format("there is no job {}", id));
  return summarise(*found);
}

core::Result<JobImage> Images::get(const std::string& id) {
  while (true) {
    auto image = develop(id);
    if (!image || image->job.state() != v1::JOB_STATE_DONE) return image;
    // The image of a done job does not change, unless the job runs again.
    const auto now = describe(id);
    if (!now) return core::fail(now.error());
    if (now->finished_at() == image->job.finished_at()) return image;
  }
}

core::Result<JobImage> Images::develop(const std::string& id) {
  auto described = describe(id);
  if (!described) return core::fail(described.error());
  const core::TileGrid grid = farm::grid_of(*described);
  JobImage result{std::move(*described), core::Image(grid.width(), grid.height())};
  auto pixel = result.image.pixels.begin();
  for (int row = 0; row < grid.rows(); ++row) {
    const auto strip = develop_row(result.job, grid, row);
    if (!strip) return core::fail(strip.error());
    pixel = std::copy(strip->pixels.begin(), strip->pixels.end(), pixel);
  }
  return result;
}

core::Result<core::Image> Images::develop_row(const v1::Job& spec, const core::TileGrid& grid, int row) {
  const int first = row * grid.columns();
  const core::PixelRect& window = grid.window();
  const core::PixelRect first_rect = grid.rect(first);
  core::Film strip(core::TileGrid({window.x0, first_rect.y0, window.x1, first_rect.y1}, grid.tile_px()));
  for (int begin = 0; begin < grid.columns(); begin += kTilesPerTurn) {
    const int end = std::min(begin + kTilesPerTurn, grid.columns());
    const auto sums = copy_tiles(spec, grid, first + begin, first + end);
    if (!sums) return core::fail(sums.error());
    for (int i = begin; i < end; ++i) strip.restore(i, (*sums)[static_cast<std::size_t>(i - begin)]);
  }
  return strip.develop();
}

core::Result<std::vector<core::Film::TileSums>> Images::copy_tiles(const v1::Job& spec,
                                                                   const core::TileGrid& grid, int begin,
                                                                   int end) {
  std::vector<core::Film::TileSums> sums;
  {
    const farm::StateLock lock(farm_);
    const farm::JobRecord* record = lock->find_job(spec.id());
    if (record == nullptr)
      return core::fail(core::ErrorCode::kNotFound, fmt::format("job {} was deleted meanwhile", spec.id()));
    if (record->film) {
      for (int tile = begin; tile < end; ++tile) sums.push_back(record->film->film().tile(tile));
      return sums;
    }
  }
  for (int tile = begin; tile < end; ++tile) {
    auto content = films_.load_tile(spec, grid, tile);
    if (!content) return core::fail(with_advice(content.error(), spec.state()));
    sums.push_back(std::move(content->sums));
  }
  return sums;
}

}  // namespace tessera::jobs
