// SPDX-License-Identifier: Apache-2.0
#include "core/textures/grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/math/lane_array.hpp"

namespace tessera::core {
namespace {

int wrapped(int i, int size, Wrap wrap) {
  if (wrap == Wrap::kClamp) return std::clamp(i, 0, size - 1);
  const int period = wrap == Wrap::kMirror ? 2 * size : size;
  const int rest = (i % period + period) % period;
  return rest < size ? rest : period - 1 - rest;
}

// Two voxels along an axis, and the share of the second one.
struct AxisVoxels {
  std::array<int, 2> voxels;
  float share;
};

AxisVoxels voxels_at(float coordinate, int size, const GridPattern& grid) {
  constexpr float kFurthest = 1 << 24;
  const bool is_linear = grid.filter == TextureFilter::kLinear;
  const float place = coordinate * static_cast<float>(size) - (is_linear ? 0.5f : 0.0f);
  const float in_range = std::isnan(place) ? 0.0f : std::clamp(place, -kFurthest, kFurthest);
  const float whole = std::floor(in_range);
  const int first = static_cast<int>(whole);
  return {{wrapped(first, size, grid.wrap), wrapped(first + 1, size, grid.wrap)},
          is_linear ? in_range - whole : 0};
}

}  // namespace

Rgb grid_value(const GridPattern& grid, const TextureImage& image, Vec3 p) {
  const int width = image.width() / grid.columns, height = image.height() / grid.rows();
  const AxisVoxels x = voxels_at(p.x, width, grid), y = voxels_at(p.y, height, grid),
                   z = voxels_at(p.z, grid.depth, grid);
  const auto voxel = [&](std::size_t i, std::size_t j, std::size_t k) {
    const int layer = z.voxels[k];
    return image.texel(layer % grid.columns * width + x.voxels[i],
                       layer / grid.columns * height + y.voxels[j]);
  };
  const auto between = [](Rgb a, Rgb b, float share) { return a * (1 - share) + b * share; };
  const auto row = [&](std::size_t j, std::size_t k) {
    return between(voxel(0, j, k), voxel(1, j, k), x.share);
  };
  return between(between(row(0, 0), row(1, 0), y.share), between(row(0, 1), row(1, 1), y.share), z.share);
}

RgbOf<FloatN> grid_value(const GridPattern& grid, const TextureImage& image, Vec3Of<FloatN> p) {
  const FloatLanes x(p.x), y(p.y), z(p.z);
  RgbLanes values;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    values.set(lane, grid_value(grid, image, Vec3{x[lane], y[lane], z[lane]}));
  return values.all();
}

}  // namespace tessera::core
