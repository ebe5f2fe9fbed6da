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

// The regular grid that a grid of a file becomes.
struct GridShape {
  IndexBox box{};                       // of the voxels of the file
  std::uint32_t reduction = 1;          // a voxel is the mean of so many of the file along each axis
  std::array<std::uint32_t, 3> size{};  // voxels along x, y and z
  // From the unit cube to the space of the file: three rows, the fourth column is the translation.
  std::array<std::array<double, 4>, 3> to_world{};

  std::uint64_t voxel_count() const { return std::uint64_t{size[0]} * size[1] * size[2]; }
};

// That of the index bounding box, with at most `max_voxels`. Errors complete a sentence that begins with the
// file's name: INVALID_ARGUMENT for a damaged grid, or one that is no fog volume of floats.
Result<GridShape> shape_of(std::string_view grid, std::uint64_t max_voxels);

// The values, with the border kZero. Negative ones and those that are not finite are 0, and the largest is
// 1e15. The same errors.
Result<VoxelGrid> voxels_of(std::string_view grid, const GridShape& shape);

}  // namespace tessera::core
