// SPDX-License-Identifier: Apache-2.0
// The film: exact sums of samples, and the images that they develop into.
//
// A FilmTile is the result of one call of render() and the unit of transfer between machines. A Film
// accumulates tiles over an image or a window of one. Neither is thread-safe; even different tiles of one
// Film must not be added concurrently.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/film/fixed_point.hpp"
#include "core/film/region.hpp"
#include "core/film/sum_buffer.hpp"
#include "core/image/image.hpp"

namespace tessera::core {

struct SampleId {
  int x = 0, y = 0;
  std::uint32_t sample = 0;
  bool operator==(const SampleId&) const = default;
};

// Counters of events during sampling. They are additive like the film.
struct RenderCounters {
  std::uint64_t samples = 0;
  std::uint64_t closest_hit_rays = 0;
  std::uint64_t shadow_rays = 0;
  std::uint64_t non_finite_samples = 0;  // counted as black
  std::uint64_t saturated_samples = 0;   // a channel exceeded the fixed-point range
  std::optional<SampleId> first_non_finite;

  // Keeps the earliest non-finite sample (by row, column, sample), so that the result does not depend on
  // the order of additions.
  void add(const RenderCounters& other);
  bool operator==(const RenderCounters&) const = default;
};

// The sums of samples `range` of the pixels of `rect`. Both buffers hold rect.height() * rect.width() * 3
// fixed-point sums (fixed_point.hpp), row-major, RGB.
struct FilmTile {
  PixelRect rect;
  SampleRange range;
  std::vector<std::uint64_t> sums;      // of all samples
  std::vector<std::uint64_t> odd_sums;  // of the odd-numbered samples
  RenderCounters counters;

  FilmTile() = default;
  FilmTile(PixelRect rect, SampleRange range);

  // Appends a tile with the same rectangle whose range begins where this one ends.
  void append(const FilmTile& next);
};

class Film {
 public:
  explicit Film(TileGrid grid);

  const TileGrid& grid() const { return grid_; }

  // Adds every sample of `tile`, whose rectangle must be a union of grid tiles. The caller ensures that no
  // sample is added twice. Counters are not kept here.
  void add(const FilmTile& tile);

  // One grid tile's sums in the layout of FilmTile, and the number of samples per pixel; empty if there are
  // none. For checkpoints: the samples need not form a range from 0.
  struct TileSums {
    std::vector<std::uint64_t> sums, odd_sums;
    std::uint32_t samples = 0, odd_samples = 0;
    bool operator==(const TileSums&) const = default;
  };
  TileSums tile(int index) const;
  // Replaces one grid tile's content. The sizes must match the tile, or be 0 if there are no samples.
  void restore(int index, const TileSums& sums);
  // The memory of the tile's sums: 0 before there are samples, and at most 48 bytes per pixel.
  std::size_t memory_bytes(int index) const;

  // Images have the size of the grid's window. Linear radiance: the mean of each pixel's samples so far;
  // black for pixels without samples.
  Image develop() const;

  // Estimated standard error of each pixel's mean, per channel, from the difference of the even- and the
  // odd-numbered samples; 0 if either half is empty.
  Image standard_error() const;

  // The number of pixels with a saturated channel sum, which are too dark.
  std::uint64_t saturated_pixels() const;

  bool operator==(const Film& other) const = default;

 private:
  struct Tile {
    SumBuffer sums, odd_sums;
    std::uint32_t samples = 0, odd_samples = 0;
    bool operator==(const Tile&) const = default;
  };

  TileGrid grid_;
  std::vector<Tile> tiles_;
};

}  // namespace tessera::core
