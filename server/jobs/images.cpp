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

core::Error with_advice(core::Error error, v1::JobState state) {
  if (error.code != core::ErrorCode::kDataLoss) return error;
  error.message += state == v1::JOB_STATE_CANCELLED || state == v1::JOB_STATE_FAILED
                       ? ": it is lost, since the job is not rendered any more: submit the scene again"
                       : ": submit the scene again; or stop the coordinator and run it once with --salvage, "
                         "after which the tile is rendered again";
  return error;
}

}  // namespace

core::Result<Images::Source> Images::find(const std::string& id) {
  const auto found = [&]() -> std::optional<std::pair<farm::JobSnapshot, std::shared_ptr<film::JobFilm>>> {
    const farm::StateLock lock(farm_);
    const farm::JobRecord* record = lock->find_job(id);
    if (record == nullptr) return std::nullopt;
    return std::pair(lock.snapshot_of(*record), record->film);
  }();
  if (!found) return core::fail(core::ErrorCode::kNotFound, fmt::format("there is no job {}", id));
  const auto& [snapshot, film] = *found;
  if (film) film->apply();
  return Source{summarise(snapshot), film};
}

core::Result<JobImage> Images::get(const std::string& id) {
  while (true) {
    auto image = develop(id);
    // A job that was extended meanwhile has another film.
    if (!image && image.error().code == core::ErrorCode::kUnavailable) image = develop(id);
    if (!image || image->job.state() != v1::JOB_STATE_DONE) return image;
    // The image of a done job does not change, unless the job runs again.
    const auto now = find(id);
    if (!now) return core::fail(now.error());
    if (now->job.finished_at() == image->job.finished_at()) return image;
  }
}

core::Result<JobImage> Images::develop(const std::string& id) {
  auto source = find(id);
  if (!source) return core::fail(source.error());
  const core::TileGrid grid = farm::grid_of(source->job);
  core::Image image(grid.width(), grid.height());
  auto pixel = image.pixels.begin();
  for (int row = 0; row < grid.rows(); ++row) {
    const auto strip = develop_row(*source, grid, row);
    if (!strip) return core::fail(strip.error());
    pixel = std::copy(strip->pixels.begin(), strip->pixels.end(), pixel);
  }
  return JobImage{std::move(source->job), std::move(image)};
}

core::Result<core::Image> Images::develop_row(const Source& source, const core::TileGrid& grid, int row) {
  const int first = row * grid.columns();
  const core::PixelRect& window = grid.window();
  const core::PixelRect first_rect = grid.rect(first);
  core::Film strip(core::TileGrid({window.x0, first_rect.y0, window.x1, first_rect.y1}, grid.tile_px()));
  for (int column = 0; column < grid.columns(); ++column) {
    const auto sums = source.film ? films_.sums(source.job, *source.film, first + column)
                                  : films_.stored_sums(source.job, first + column);
    if (!sums) return core::fail(with_advice(sums.error(), source.job.state()));
    if (source.job.state() == v1::JOB_STATE_DONE && sums->samples < source.job.settings().spp())
      return core::fail(
          with_advice({core::ErrorCode::kDataLoss,
                       fmt::format("tile {} of job {} lacks samples", first + column, source.job.id())},
                      source.job.state()));
    strip.restore(column, *sums);
  }
  return strip.develop();
}

}  // namespace tessera::jobs
