// SPDX-License-Identifier: Apache-2.0
// Grids of floats in NanoVDB's layout (Museth 2021), as regular grids: leaves of 8^3 voxels, below nodes of
// 16^3 and 32^3 children, below a table.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "core/base/error.hpp"
#include "core/media/voxel_grid.hpp"

namespace tessera::core {

// A box of indices; `max` is beyond the last one.
struct IndexBox {
  std::array<std::int64_t, 3> min{}, max{};

  std::int64_t side(std::size_t axis) const { return max[axis] - min[axis]; }
};

struct DenseGrid {
  VoxelGrid voxels;             // with the border kZero; negative values and those that are not finite are 0
  IndexBox box{};               // of the voxels of the file
  std::uint32_t reduction = 1;  // a voxel is the mean of so many of the file along each axis
  // From the unit cube to the space of the file: three rows, the fourth column is the translation.
  std::array<std::array<double, 4>, 3> to_world{};
};

// The voxels of the index bounding box, at most `max_voxels` of them. Errors complete a sentence that begins
// with the file's name: INVALID_ARGUMENT for a damaged grid, or one that has no floats.
Result<DenseGrid> dense_grid(std::string_view grid, std::uint64_t max_voxels);
// The voxels of another grid's box, at its places.
Result<DenseGrid> dense_grid(std::string_view grid, const DenseGrid& other);

}  // namespace tessera::core
