// SPDX-License-Identifier: Apache-2.0
#include "server/jobs/image_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "server/scheduler/item_text.hpp"

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

ImageRows::ImageRows(const FilmReader& films, ImageSource source, const core::PixelRect& region)
    : films_(films), source_(std::move(source)), grid_(source_.shape.grid().of_image()), region_(region) {}

core::Result<const core::Rgb*> ImageRows::row(int y) {
  const int y_of_window = region_.y0 + y - grid_.window().y0;
  const int tile_row = y_of_window / grid_.tile_px();
  if (tile_row_ != tile_row) {
    if (auto developed = develop(tile_row); !developed) return core::fail(developed.error());
  }
  return &strip_.at(0, y_of_window % grid_.tile_px());
}

core::Status ImageRows::develop(int tile_row) {
  tile_row_.reset();
  if (strip_.pixels.empty()) strip_ = core::Image(region_.width(), grid_.tile_px());
  const int first = grid_.tile_at(region_.x0, region_.y0) % grid_.columns();
  const int last = grid_.tile_at(region_.x1 - 1, region_.y0) % grid_.columns();
  for (int column = first; column <= last; ++column) {
    const int tile = tile_row * grid_.columns() + column;
    const auto pixels = develop_tile(tile);
    if (!pixels) return core::fail(pixels.error());
    const core::PixelRect rect = grid_.rect(tile);
    const int x0 = std::max(rect.x0, region_.x0), x1 = std::min(rect.x1, region_.x1);
    for (int y = 0; y < rect.height(); ++y)
      std::copy_n(&pixels->at(x0 - rect.x0, y), x1 - x0, &strip_.at(x0 - region_.x0, y));
  }
  tile_row_ = tile_row;
  return {};
}

core::Result<core::Image> ImageRows::develop_tile(int tile) const {
  const v1::Job& job = source_.job;
  const scheduler::JobGrid all = source_.shape.grid();
  const int of_job = all.first_tile(source_.image) + tile;
  const auto sums = source_.film ? films_.sums(job, *source_.film, of_job) : films_.stored_sums(job, of_job);
  if (!sums) return core::fail(with_advice(sums.error(), job.state()));
  if (job.state() == v1::JOB_STATE_DONE && sums->samples < source_.shape.target(of_job)) {
    const std::string what =
        fmt::format("{} of job {} lacks samples", scheduler::describe_tile(all, of_job), job.id());
    return core::fail(with_advice({core::ErrorCode::kDataLoss, what}, job.state()));
  }
  core::Film alone(core::TileGrid(grid_.rect(tile), grid_.tile_px()));
  alone.restore(0, *sums);
  return alone.develop();
}

}  // namespace tessera::jobs
