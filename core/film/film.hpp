// SPDX-License-Identifier: Apache-2.0
// The film: exact sums of samples, and the image they develop into.
//
// A FilmTile is what one call of render() returns and what travels between machines; a Film is the
// accumulation of them over an image, or a window of one. Neither is thread-safe; different tiles of one
// Film may not be added concurrently.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/film/fixed_point.hpp"
#include "core/film/layout.hpp"
#include "core/film/planes.hpp"
#include "core/film/region.hpp"
#include "core/film/sum_buffer.hpp"
#include "core/image/image.hpp"

namespace tessera::core {

struct SampleId {
  int x = 0, y = 0;
  std::uint32_t sample = 0;
  bool operator==(const SampleId&) const = default;
};

// What happened while samples were taken. Counters add up like the film does.
struct RenderCounters {
  std::uint64_t samples = 0;
  std::uint64_t closest_hit_rays = 0;
  std::uint64_t shadow_rays = 0;
  std::uint64_t non_finite_samples = 0;  // counted as black
  std::uint64_t saturated_samples = 0;   // a channel did not fit the fixed-point range
  std::optional<SampleId> first_non_finite;

  // The earliest non-finite sample (by row, column, sample) is kept, so that the sum does not depend on
  // order.
  void add(const RenderCounters& other);
  bool operator==(const RenderCounters&) const = default;
};

// Samples `range` of the pixels of `rect`, summed: the words of film_layout(layers), as layout.hpp arranges
// them. `sums` and `odd_sums` hold rect.height() * rect.width() * 3 fixed-point sums (fixed_point.hpp),
// row-major, RGB.
struct FilmTile {
  PixelRect rect;
  SampleRange range;
  std::vector<std::uint64_t> sums;      // of all samples
  std::vector<std::uint64_t> odd_sums;  // of those with an odd number
  RenderCounters counters;
  LayerSet layers{};
  Planes planes{};  // of the layers

  FilmTile() = default;
  // Without samples. The planes are there, and empty.
  FilmTile(PixelRect rect, SampleRange range, LayerSet layers = {});

  // Appends a tile of the same rectangle whose range begins where this one's ends.
  void append(const FilmTile& next);
};

class Film {
 public:
  explicit Film(TileGrid grid, LayerSet layers = {});

  const TileGrid& grid() const { return grid_; }
  LayerSet layers() const { return layers_; }

  // Adds every sample of `tile`, whose rectangle must be a union of grid tiles, and which must have the
  // layers of the film. The caller ensures that no sample is added twice. Counters are not kept here.
  void add(const FilmTile& tile);

  // One grid tile's sums in the layout of FilmTile, and how many samples of each pixel they hold; empty where
  // there are none. For checkpoints: the samples need not be a range from 0.
  struct TileSums {
    std::vector<std::uint64_t> sums, odd_sums;
    std::uint32_t samples = 0, odd_samples = 0;
    Planes planes{};
    bool operator==(const TileSums&) const = default;
  };
  TileSums tile(int index) const;
  // How many samples of each pixel of one grid tile there are.
  std::uint32_t samples(int index) const { return tiles_[static_cast<std::size_t>(index)].samples; }
  // Replaces one grid tile's content. The sizes must be those of the tile, or 0 if there are no samples.
  void restore(int index, const TileSums& sums);

  // The images are of the grid's window, and of its size.
  // Linear radiance: each pixel the mean of the samples it has so far; black where it has none.
  Image develop() const;

  // Estimated standard error of each pixel's mean, per channel, from the difference of the even- and the
  // odd-numbered samples; 0 where either half is empty.
  Image standard_error() const;

  // Pixels of which a channel's sum has reached the end of its range: they come out too dark.
  std::uint64_t saturated_pixels() const;

  bool operator==(const Film& other) const = default;

 private:
  struct Tile {
    SumBuffer sums, odd_sums;
    std::uint32_t samples = 0, odd_samples = 0;
    Planes planes{};
    bool operator==(const Tile&) const = default;
  };

  TileGrid grid_;
  LayerSet layers_;
  FilmLayout layout_;
  std::vector<Tile> tiles_;
};

// The pixels of one grid tile, as Film::develop() of a film gives them.
Image develop_tile(const PixelRect& rect, const Film::TileSums& sums);

}  // namespace tessera::core
