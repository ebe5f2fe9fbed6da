// SPDX-License-Identifier: Apache-2.0
#include "core/media/voxel_grid.hpp"

#include <algorithm>
#include <cmath>

namespace tessera::core {
namespace {

// The voxel's value; outside of the grid that of the border.
Rgb voxel(const VoxelGrid& grid, std::array<int, 3> at) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int last = static_cast<int>(grid.size[axis]) - 1;
    if (grid.border == GridBorder::kZero && (at[axis] < 0 || at[axis] > last)) return {};
    at[axis] = std::clamp(at[axis], 0, last);
  }
  const auto [x, y, z] = at;
  const std::size_t index =
      (static_cast<std::size_t>(z) * grid.size[1] + static_cast<std::size_t>(y)) * grid.size[0] +
      static_cast<std::size_t>(x);
  if (grid.channels == 1) return Rgb::gray(grid.values[index]);
  return {grid.values[3 * index], grid.values[3 * index + 1], grid.values[3 * index + 2]};
}

Rgb between(Rgb a, Rgb b, float share) {
  return a * (1 - share) + b * share;
}

bool is_in_cube(Vec3 p) {
  const auto is_share = [](float c) { return c >= 0 && c <= 1; };
  return is_share(p.x) && is_share(p.y) && is_share(p.z);
}

// The coordinate in voxels along an axis, in which voxel i has its centre at i.
float in_voxels(const VoxelGrid& grid, Vec3 p, int axis) {
  return p[axis] * static_cast<float>(grid.size[static_cast<std::size_t>(axis)]) - 0.5f;
}

Rgb nearest(const VoxelGrid& grid, Vec3 p) {
  std::array<int, 3> at{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    at[a] = std::min(static_cast<int>(p[axis] * static_cast<float>(grid.size[a])),
                     static_cast<int>(grid.size[a]) - 1);
  }
  return voxel(grid, at);
}

Rgb linear(const VoxelGrid& grid, Vec3 p) {
  std::array<int, 3> at{};
  std::array<float, 3> share{};
  for (int axis = 0; axis < 3; ++axis) {
    const float v = in_voxels(grid, p, axis), below = std::floor(v);
    at[static_cast<std::size_t>(axis)] = static_cast<int>(below);
    share[static_cast<std::size_t>(axis)] = v - below;
  }
  const auto along_x = [&](int dy, int dz) {
    return between(voxel(grid, {at[0], at[1] + dy, at[2] + dz}),
                   voxel(grid, {at[0] + 1, at[1] + dy, at[2] + dz}), share[0]);
  };
  return between(between(along_x(0, 0), along_x(1, 0), share[1]),
                 between(along_x(0, 1), along_x(1, 1), share[1]), share[2]);
}

}  // namespace

bool is_sound(const VoxelGrid& grid) {
  for (const std::uint32_t side : grid.size)
    if (side == 0 || side > kMaxGridSide) return false;
  if (grid.channels != 1 && grid.channels != 3) return false;
  if (grid.values.size() != grid.voxel_count() * grid.channels) return false;
  return std::all_of(grid.values.begin(), grid.values.end(),
                     [](float v) { return std::isfinite(v) && v >= 0; });
}

Rgb value_at(const VoxelGrid& grid, Vec3 p) {
  if (!is_in_cube(p)) return {};
  return grid.filter == GridFilter::kNearest ? nearest(grid, p) : linear(grid, p);
}

// One voxel more on each side, against rounding.
Rgb bound_in(const VoxelGrid& grid, Vec3 lower, Vec3 upper) {
  std::array<int, 3> first{}, last{};
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const int side = static_cast<int>(grid.size[a]);
    first[a] = std::clamp(static_cast<int>(std::floor(in_voxels(grid, lower, axis))) - 1, 0, side - 1);
    last[a] = std::clamp(static_cast<int>(std::floor(in_voxels(grid, upper, axis))) + 2, 0, side - 1);
  }
  Rgb most;
  for (int z = first[2]; z <= last[2]; ++z)
    for (int y = first[1]; y <= last[1]; ++y)
      for (int x = first[0]; x <= last[0]; ++x) {
        const Rgb v = voxel(grid, {x, y, z});
        most = {std::max(most.r, v.r), std::max(most.g, v.g), std::max(most.b, v.b)};
      }
  return most;
}

}  // namespace tessera::core
