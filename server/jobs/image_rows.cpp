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

core::Result<core::Film::TileSums> ImageTiles::sums(int tile) const {
  const v1::Job& job = source_.job;
  const scheduler::JobGrid all = source_.shape.grid();
  const int of_job = all.first_tile(source_.image) + tile;
  auto sums = source_.film ? films_.sums(job, *source_.film, of_job) : films_.stored_sums(job, of_job);
  if (!sums) return core::fail(with_advice(sums.error(), job.state()));
  if (job.state() == v1::JOB_STATE_DONE && sums->samples < source_.shape.target(of_job)) {
    const std::string what =
        fmt::format("{} of job {} lacks samples", scheduler::describe_tile(all, of_job), job.id());
    return core::fail(with_advice({core::ErrorCode::kDataLoss, what}, job.state()));
  }
  return sums;
}

core::Result<const core::Rgb*> ImageRows::row(int y) {
  const core::TileGrid& grid = tiles_.grid();
  const int y_of_window = region_.y0 + y - grid.window().y0;
  const int tile_row = y_of_window / grid.tile_px();
  if (tile_row_ != tile_row) {
    if (auto developed = develop(tile_row); !developed) return core::fail(developed.error());
  }
  return &strip_.at(0, y_of_window % grid.tile_px());
}

core::Status ImageRows::develop(int tile_row) {
  const core::TileGrid& grid = tiles_.grid();
  tile_row_.reset();
  if (strip_.pixels.empty()) strip_ = core::Image(region_.width(), grid.tile_px());
  const int first = grid.tile_at(region_.x0, region_.y0) % grid.columns();
  const int last = grid.tile_at(region_.x1 - 1, region_.y0) % grid.columns();
  for (int column = first; column <= last; ++column) {
    const int tile = tile_row * grid.columns() + column;
    const auto pixels = develop_tile(tile);
    if (!pixels) return core::fail(pixels.error());
    const core::PixelRect rect = grid.rect(tile);
    const int x0 = std::max(rect.x0, region_.x0), x1 = std::min(rect.x1, region_.x1);
    for (int y = 0; y < rect.height(); ++y)
      std::copy_n(&pixels->at(x0 - rect.x0, y), x1 - x0, &strip_.at(x0 - region_.x0, y));
  }
  tile_row_ = tile_row;
  return {};
}

core::Result<core::Image> ImageRows::develop_tile(int tile) const {
  const auto sums = tiles_.sums(tile);
  if (!sums) return core::fail(sums.error());
  const core::PixelRect rect = tiles_.grid().rect(tile);
  if (layer_) return view::develop_layer(tiles_.layers(), *layer_, rect, *sums, 0);
  core::Film alone(core::TileGrid(rect, tiles_.grid().tile_px()));
  alone.restore(0, {sums->sums, sums->odd_sums, sums->samples, sums->odd_samples, {}});
  return alone.develop();
}

LayeredImageRows::LayeredImageRows(const FilmReader& films, ImageSource source, const core::PixelRect& region)
    : tiles_(films, std::move(source)),
      rows_(tiles_.grid(), region, tiles_.layers(), [this](int tile) { return tiles_.sums(tile); }) {}

}  // namespace tessera::jobs
