// SPDX-License-Identifier: Apache-2.0
// A regular grid of values over the unit cube, for media that vary in space.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/math/rgb.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

enum class GridFilter {
  kLinear,   // trilinear between the centres of voxels
  kNearest,  // constant in each voxel
};

// The values between the outermost voxel centres and the faces of the cube. Outside of the cube a grid is 0.
enum class GridBorder {
  kClamp,  // those of the outermost voxels
  kZero,   // a linear grid falls off as if further voxels were 0
};

inline constexpr std::uint32_t kMaxGridSide = 1u << 14;

struct VoxelGrid {
  std::array<std::uint32_t, 3> size{};  // voxels along x, y and z
  std::uint32_t channels = 1;           // 1, or 3 for red, green and blue
  std::vector<float> values{};          // a voxel's channels together; x runs fastest, z slowest
  GridFilter filter = GridFilter::kLinear;
  GridBorder border = GridBorder::kClamp;

  std::size_t voxel_count() const { return std::size_t{size[0]} * size[1] * size[2]; }
};

// Whether the sizes agree and all values are finite and not negative.
bool is_sound(const VoxelGrid& grid);

// The value at a point of the unit cube; 0 outside. A single channel counts for all three.
Rgb value_at(const VoxelGrid& grid, Vec3 p);

// An upper bound of value_at() in the box from `lower` to `upper`.
Rgb bound_in(const VoxelGrid& grid, Vec3 lower, Vec3 upper);

}  // namespace tessera::core
