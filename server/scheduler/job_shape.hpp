// SPDX-License-Identifier: Apache-2.0
// The work of a job: its images, their tiles, and the samples that each tile is to get. Plain values; copies
// share what is large.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/error.hpp"
#include "core/film/region.hpp"

namespace tessera::scheduler {

// The tile of a WorkItem whose rectangle is no tile of the grid. Results with it are refused.
inline constexpr int kNoTile = -1;

// No job has more tiles.
inline constexpr int kMaxTilesPerJob = 1 << 28;
// No job has more tiles with targets of their own: to change one copies them all, eight bytes each.
inline constexpr std::size_t kMaxTileTargets = 4096;

// The tiles of all images of a job, which are of one size. They are numbered in one sequence: image by image,
// and row by row in each image.
class JobGrid {
 public:
  // NOLINTNEXTLINE(google-explicit-constructor): a grid is that of a job of one image
  JobGrid(core::TileGrid image, int images = 1)
      : image_(image), images_(images), tiles_per_image_(image.tile_count()) {}

  // The tiles of each image.
  const core::TileGrid& of_image() const { return image_; }
  const core::PixelRect& window() const { return image_.window(); }
  int image_count() const { return images_; }
  int tiles_per_image() const { return tiles_per_image_; }
  int tile_count() const { return images_ * tiles_per_image_; }

  int image_of(int tile) const { return tile / tiles_per_image_; }
  int first_tile(int image) const { return image * tiles_per_image_; }
  core::PixelRect rect(int tile) const { return image_.rect(tile % tiles_per_image_); }
  // The tile of this image with this rectangle, or kNoTile.
  int find(std::uint32_t image, const core::PixelRect& rect) const {
    if (image >= static_cast<std::uint32_t>(images_) || rect.empty() || !window().contains(rect))
      return kNoTile;
    const int tile = image_.tile_at(rect.x0, rect.y0);
    return image_.rect(tile) == rect ? first_tile(static_cast<int>(image)) + tile : kNoTile;
  }
  bool operator==(const JobGrid&) const = default;

 private:
  core::TileGrid image_;
  int images_;
  int tiles_per_image_;
};

// How many samples a tile is to get.
struct TileTarget {
  int tile = 0;
  std::uint32_t spp = 0;
  auto operator<=>(const TileTarget&) const = default;
};

// The tiles of a job that are to get another number of samples than the others. Usually there are none.
class TileTargets {
 public:
  using ByTile = std::vector<TileTarget>;

  TileTargets() = default;
  // In any order. Of several targets of one tile the highest counts.
  explicit TileTargets(ByTile targets);

  // By tile, each once.
  const ByTile& all() const {
    static const ByTile kNone;
    return targets_ ? *targets_ : kNone;
  }
  // Null if the tile has no target of its own.
  const TileTarget* find(int tile) const;
  bool operator==(const TileTargets& other) const {
    return targets_ == other.targets_ || all() == other.all();
  }

 private:
  std::shared_ptr<const ByTile> targets_;  // null if there are none
};

// Samples [0, target) of every pixel of each tile of a window of each image.
struct JobShape {
  core::PixelRect window;
  // The target of every tile that has no other.
  std::uint32_t spp = 0;
  int images = 1;
  // Its samples have more than R, G and B.
  bool has_layers = false;
  TileTargets targets{};

  JobShape() = default;
  JobShape(core::PixelRect of_image, std::uint32_t samples, int image_count = 1)
      : window(of_image), spp(samples), images(image_count) {}
  // The whole image.
  JobShape(int width_px, int height_px, std::uint32_t samples, int image_count = 1)
      : JobShape({0, 0, width_px, height_px}, samples, image_count) {}

  JobGrid grid() const { return {core::TileGrid(window, core::kTilePx), images}; }
  std::uint32_t target(int tile) const {
    const TileTarget* const own = targets.find(tile);
    return own == nullptr ? spp : own->spp;
  }
  // The pixel samples of all tiles together, and of those of each image, in time linear in the exceptions.
  std::uint64_t pixel_samples() const;
  std::uint64_t pixel_samples_of(int image) const;
  // Raises the targets of all tiles to this number at least (0: leaves them), and those of single tiles
  // further. Lowers none. Returns the pixel samples that are added. With single tiles alone, the time depends
  // on their number, but for a copy of the list of targets.
  std::uint64_t raise(std::uint32_t to_spp, const std::vector<TileTarget>& tiles = {});
  // Whether that would change anything.
  bool is_raised_by(std::uint32_t to_spp, const std::vector<TileTarget>& tiles) const;
  bool operator==(const JobShape&) const = default;
};

// INVALID_ARGUMENT if no job can have the shape: it has nothing to render, too many tiles, or targets of
// tiles that it does not have, or of too many.
core::Status check_shape(const JobShape& shape);

}  // namespace tessera::scheduler
