// SPDX-License-Identifier: Apache-2.0
// Writes grids of media. Stateless; thread-safe.
#pragma once

#include <string>

#include "core/media/voxel_grid.hpp"

namespace tessera::core {

// A grid volume file of Mitsuba, version 3: 48 bytes of header, then 32-bit floats, little-endian.
std::string write_volume(const VoxelGrid& grid);

}  // namespace tessera::core
