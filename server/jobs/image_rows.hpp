// SPDX-License-Identifier: Apache-2.0
// Develops an image of a job some rows at a time, so that it need not fit into memory. For one thread at a
// time; blocks for the disk where films are stored.
#pragma once

#include <memory>
#include <optional>

#include "core/base/error.hpp"
#include "core/image/image.hpp"
#include "server/film/job_film.hpp"
#include "server/jobs/film_reader.hpp"
#include "tessera/v1/types.pb.h"

namespace tessera::jobs {

// An image of a job at one moment.
struct ImageSource {
  v1::Job job;  // without its bundle
  scheduler::JobShape shape;
  std::shared_ptr<film::JobFilm> film;  // null if the store alone has it
  int image = 0;
};

class ImageRows {
 public:
  // `region`: the pixels to develop, within the job's window.
  ImageRows(const FilmReader& films, ImageSource source, const core::PixelRect& region);

  const v1::Job& job() const { return source_.job; }
  int width() const { return region_.width(); }
  int height() const { return region_.height(); }
  // A row of the region, from 0; valid until the next call. Rows of a row of tiles are developed together:
  // call it in their order. DATA_LOSS if the store has lost a tile, or a tile of a done job lacks samples.
  core::Result<const core::Rgb*> row(int y);

  // The memory that rows of this many pixels take.
  static std::uint64_t bytes(std::uint64_t width) { return width * core::kTilePx * sizeof(core::Rgb); }

 private:
  core::Status develop(int tile_row);
  // `tile`: of the image.
  core::Result<core::Image> develop_tile(int tile) const;

  const FilmReader& films_;
  const ImageSource source_;
  const core::TileGrid grid_;
  const core::PixelRect region_;
  std::optional<int> tile_row_;  // the one that is developed
  core::Image strip_;            // its pixels in the columns of the region
};

}  // namespace tessera::jobs
