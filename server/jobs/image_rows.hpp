// SPDX-License-Identifier: Apache-2.0
// Develops an image of a job some rows at a time, so that it need not fit into memory. For one thread at a
// time; blocks for the disk where films are stored.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "core/film/develop.hpp"
#include "core/film/layers.hpp"
#include "core/image/image.hpp"
#include "core/scene/render_record.hpp"
#include "core/view/shown_layer.hpp"
#include "server/farm/job_record.hpp"
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
  // What the header of EXR files says; not of jobs of releases that knew no digest of scenes.
  std::optional<core::RenderRecord> record{};
  core::TextAttributes attributes{};  // besides the record
};

// The samples of the tiles of an image.
class ImageTiles {
 public:
  ImageTiles(const FilmReader& films, ImageSource source)
      : films_(films), source_(std::move(source)), grid_(source_.shape.grid().of_image()) {}

  const v1::Job& job() const { return source_.job; }
  const core::TileGrid& grid() const { return grid_; }
  core::LayerSet layers() const { return farm::layers_of(source_.job); }
  // DATA_LOSS if the store has lost the tile, or if it lacks samples and the job is done.
  core::Result<core::Film::TileSums> sums(int tile) const;

 private:
  const FilmReader& films_;
  const ImageSource source_;
  const core::TileGrid grid_;
};

// The beauty, or a layer in three channels.
class ImageRows {
 public:
  // `region`: the pixels to develop, within the job's window. The job must have the layer.
  ImageRows(const FilmReader& films, ImageSource source, const core::PixelRect& region,
            view::ShownLayer layer = {})
      : tiles_(films, std::move(source)), region_(region), layer_(layer) {}

  const v1::Job& job() const { return tiles_.job(); }
  int width() const { return region_.width(); }
  int height() const { return region_.height(); }
  // A row of the region, from 0; valid until the next call. Rows of a row of tiles are developed together:
  // call it in their order. Errors are those of ImageTiles.
  core::Result<const core::Rgb*> row(int y);

  // The memory that rows of this many pixels take.
  static std::uint64_t bytes(std::uint64_t width) { return width * core::kTilePx * sizeof(core::Rgb); }

 private:
  core::Status develop(int tile_row);
  // `tile`: of the image.
  core::Result<core::Image> develop_tile(int tile) const;

  const ImageTiles tiles_;
  const core::PixelRect region_;
  const view::ShownLayer layer_;
  std::optional<int> tile_row_;  // the one that is developed
  core::Image strip_;            // its pixels in the columns of the region
};

// The beauty with all layers.
class LayeredImageRows {
 public:
  LayeredImageRows(const FilmReader& films, ImageSource source, const core::PixelRect& region);
  LayeredImageRows(const LayeredImageRows&) = delete;
  LayeredImageRows& operator=(const LayeredImageRows&) = delete;

  const v1::Job& job() const { return tiles_.job(); }
  std::vector<std::string> channels() const { return core::image_channels(tiles_.layers()); }
  // As in ImageRows: core::image_channels() of each pixel side by side.
  core::Result<const float*> row(int y) { return rows_.row(y); }

  static std::uint64_t bytes(std::uint64_t width, std::size_t channels) {
    return width * core::kTilePx * channels * sizeof(float);
  }

 private:
  const ImageTiles tiles_;
  core::LayerRows rows_;
};

}  // namespace tessera::jobs
