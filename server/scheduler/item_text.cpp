// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/item_text.hpp"

#include <fmt/format.h>

namespace tessera::scheduler {

std::string describe_tile(const JobGrid& grid, int tile) {
  if (grid.image_count() == 1) return fmt::format("tile {}", tile);
  return fmt::format("tile {} of image {}", tile % grid.tiles_per_image(), grid.image_of(tile));
}

std::string describe_item(const JobGrid& grid, const WorkItem& item) {
  return fmt::format("samples [{}, {}) of {}", item.samples.begin, item.samples.end,
                     describe_tile(grid, item.tile));
}

std::string describe_item_with_pixels(const JobGrid& grid, const WorkItem& item) {
  const core::PixelRect rect = grid.rect(item.tile);
  return fmt::format("{} (pixels [{}, {}) x [{}, {}))", describe_item(grid, item), rect.x0, rect.x1, rect.y0,
                     rect.y1);
}

}  // namespace tessera::scheduler
