// SPDX-License-Identifier: Apache-2.0
// Small images of jobs. Each keeps the means of its tiles, so that only those that have changed are read for
// the next one. Thread-safe.
#pragma once

#include <chrono>
#include <list>
#include <memory>
#include <mutex>
#include <string>

#include "core/base/error.hpp"
#include "core/image/display.hpp"
#include "core/view/tile_source.hpp"

namespace tessera::view {

inline constexpr int kMaxThumbnailPx = 512;

struct Thumbnail {
  std::string png;
  // Tells its content; with quotation marks.
  std::string etag;
  // If not, there was no time to read all tiles: some are as they were before, or black.
  bool is_current = true;
};

class Thumbnails {
 public:
  Thumbnails();
  ~Thumbnails();

  // At most `size_px` (to kMaxThumbnailPx) wide and high. FAILED_PRECONDITION if the job has no image.
  core::Result<std::shared_ptr<const Thumbnail>> get(TileSource& source, int size_px,
                                                     const core::DisplaySettings& display,
                                                     std::chrono::steady_clock::time_point deadline);

 private:
  class Entry;
  std::shared_ptr<Entry> entry(const std::string& id, const core::TileGrid& grid);

  std::mutex mutex_;
  // Least recently used first; guarded by mutex_.
  std::list<std::shared_ptr<Entry>> entries_;
};

}  // namespace tessera::view
