// SPDX-License-Identifier: Apache-2.0
#include "core/view/thumbnails.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <utility>

#include "core/image/encode.hpp"
#include "core/view/tile_pixels.hpp"

namespace tessera::view {
namespace {

using Clock = std::chrono::steady_clock;

// Of the jobs that somebody sees in a list.
constexpr std::size_t kMaxEntries = 32;
constexpr std::size_t kThumbnailChanges = 256;

// The finest level of at most kMaxThumbnailPx, if there is one.
int thumbnail_level(const core::PixelRect& window) {
  int level = 0;
  while (level < kMaxLevel && level_size(std::max(window.width(), window.height()), level) > kMaxThumbnailPx)
    ++level;
  return level;
}

// The means over parts of the image, which becomes at most `size_px` wide and high.
core::Image shrink(const core::Image& image, int size_px) {
  const int longer = std::max(image.width, image.height);
  if (longer <= size_px) return image;
  const auto scaled = [&](int side) {
    return std::max(1, static_cast<int>(std::int64_t{side} * size_px / longer));
  };
  core::Image small(scaled(image.width), scaled(image.height));
  for (int y = 0; y < small.height; ++y) {
    const int y0 = y * image.height / small.height, y1 = (y + 1) * image.height / small.height;
    for (int x = 0; x < small.width; ++x) {
      const int x0 = x * image.width / small.width, x1 = (x + 1) * image.width / small.width;
      core::Rgb sum;
      for (int from_y = y0; from_y < y1; ++from_y)
        for (int from_x = x0; from_x < x1; ++from_x) sum = sum + image.at(from_x, from_y);
      small.at(x, y) = sum * (1.0f / static_cast<float>((x1 - x0) * (y1 - y0)));
    }
  }
  return small;
}

}  // namespace

class Thumbnails::Entry {
 public:
  Entry(std::string id, const core::TileGrid& grid)
      : id_(std::move(id)),
        grid_(grid),
        level_(thumbnail_level(grid.window())),
        image_(level_size(grid.width(), level_), level_size(grid.height(), level_)) {}

  const std::string& id() const { return id_; }
  const core::TileGrid& grid() const { return grid_; }

  core::Result<std::shared_ptr<const Thumbnail>> get(TileSource& source, int size_px,
                                                     const core::DisplaySettings& display,
                                                     Clock::time_point deadline) {
    const std::lock_guard lock(mutex_);
    const auto is_current = update(source, deadline);
    if (!is_current) return core::fail(is_current.error());
    std::string etag = fmt::format("\"{}-{}-{}-{}\"", seen_, size_px, display.exposure_stops,
                                   core::tone_curve_name(display.tone_curve));
    if (!last_ || last_->etag != etag || last_->is_current != *is_current) {
      auto png = core::encode_image(shrink(image_, size_px), core::ImageFormat::kPng, display);
      if (!png) return core::fail(png.error());
      last_ = std::make_shared<const Thumbnail>(Thumbnail{std::move(*png), std::move(etag), *is_current});
    }
    return last_;
  }

 private:
  // Whether all changes were read.
  core::Result<bool> update(TileSource& source, Clock::time_point deadline) {
    for (;;) {
      const auto changes = source.changes_since(seen_, kThumbnailChanges);
      if (!changes) return core::fail(changes.error());
      for (const TileChange& change : *changes) {
        if (Clock::now() >= deadline) return false;
        const auto tile = source.read(change);
        if (!tile) return core::fail(tile.error());
        put(grid_.rect(change.tile), tile->sums);
        seen_ = change.revision;
      }
      if (changes->size() < kThumbnailChanges) return true;
    }
  }

  void put(const core::PixelRect& rect, const core::Film::TileSums& sums) {
    const core::Image tile = develop_level(rect, sums, level_);
    const int x0 = (rect.x0 - grid_.window().x0) >> level_, y0 = (rect.y0 - grid_.window().y0) >> level_;
    for (int y = 0; y < tile.height; ++y)
      for (int x = 0; x < tile.width; ++x) image_.at(x0 + x, y0 + y) = tile.at(x, y);
  }

  const std::string id_;
  const core::TileGrid grid_;
  const int level_;

  std::mutex mutex_;
  // Guarded by mutex_:
  core::Image image_;
  Revision seen_ = 0;
  std::shared_ptr<const Thumbnail> last_;
};

Thumbnails::Thumbnails() = default;
Thumbnails::~Thumbnails() = default;

std::shared_ptr<Thumbnails::Entry> Thumbnails::entry(const std::string& id, const core::TileGrid& grid) {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(entries_.begin(), entries_.end(), [&](const auto& entry) {
    return entry->id() == id && entry->grid() == grid;
  });
  if (found != entries_.end()) {
    entries_.splice(entries_.end(), entries_, found);
    return entries_.back();
  }
  if (entries_.size() >= kMaxEntries) entries_.pop_front();
  return entries_.emplace_back(std::make_shared<Entry>(id, grid));
}

core::Result<std::shared_ptr<const Thumbnail>> Thumbnails::get(TileSource& source, int size_px,
                                                               const core::DisplaySettings& display,
                                                               Clock::time_point deadline) {
  const auto grid = source.grid();
  if (!grid) return core::fail(core::ErrorCode::kFailedPrecondition, "the job has no image yet");
  return entry(source.id(), *grid)->get(source, std::clamp(size_px, 1, kMaxThumbnailPx), display, deadline);
}

}  // namespace tessera::view
