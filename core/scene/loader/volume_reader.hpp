// SPDX-License-Identifier: Apache-2.0
// Reads the grid volume format of Mitsuba, version 3 (.vol): 48 bytes of header ("VOL", version, encoding,
// size, channels, bounds), then the values as 32-bit floats, little-endian, channels first, then x, y and z.
#pragma once

#include <string_view>

#include "core/base/error.hpp"
#include "core/media/voxel_grid.hpp"

namespace tessera::core {

inline constexpr std::string_view kVolumeMagic = "VOL";

// With a linear filter and a clamped border. The bounds in the file are not used. INVALID_ARGUMENT, without
// the file's name, if it is damaged, has another encoding, or a value that is negative or not finite.
Result<VoxelGrid> read_volume(std::string_view bytes);

}  // namespace tessera::core
