// SPDX-License-Identifier: Apache-2.0
// Work items in sentences for people. Pure functions.
#pragma once

#include <string>

#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

// "tile 3"; of a job of several images "tile 3 of image 2". Both are counted from 0.
std::string describe_tile(const JobGrid& grid, int tile);
// "samples [0, 1) of tile 3".
std::string describe_item(const JobGrid& grid, const WorkItem& item);
// "samples [0, 1) of tile 3 (pixels [192, 256) x [0, 64))".
std::string describe_item_with_pixels(const JobGrid& grid, const WorkItem& item);

}  // namespace tessera::scheduler
