// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/cloud_density.hpp"

#include <algorithm>
#include <cmath>

#include "core/textures/noise.hpp"

namespace tessera::core::pbrt {
namespace {

constexpr float kVoxelsOfLongestSide = 128;

// The gradient of the noise by finite differences.
Vec3 noise_gradient(Vec3 p) {
  constexpr float kStep = 0.01f;
  const float here = perlin_noise<float>(p);
  const auto slope = [&](Vec3 step) { return (perlin_noise<float>(p + step) - here) / kStep; };
  return {slope({kStep, 0, 0}), slope({0, kStep, 0}), slope({0, 0, kStep})};
}

}  // namespace

float CloudDensity::at(Vec3 point) const {
  if (point.y <= 0) return 1;  // whatever the noise is
  constexpr int kWispOctaves = 2, kOctaves = 5;
  Vec3 p = point * frequency;
  float shift = 0.05f * std::max(wispiness, 0.0f), shift_frequency = 10;
  for (int octave = 0; octave < kWispOctaves && shift > 0; ++octave) {
    p = p + noise_gradient(p * shift_frequency) * shift;
    shift *= 0.5f;
    shift_frequency *= kLacunarity;
  }
  const float noise = 0.5f * fbm<float>(p, 0.5f, kOctaves);
  const float falling = std::clamp((1 - point.y) * 4.5f * density * noise, 0.0f, 1.0f);
  const float value = std::clamp(falling + 2 * std::max(0.0f, 0.5f - point.y), 0.0f, 1.0f);
  return std::isfinite(value) ? value : 0;
}

std::optional<std::array<std::uint32_t, 3>> CloudDensity::grid_size(Vec3 from, Vec3 to) {
  const Vec3 sides = to - from;
  const float longest = std::max({std::fabs(sides.x), std::fabs(sides.y), std::fabs(sides.z)});
  if (!is_finite(from) || !is_finite(sides) || longest == 0) return std::nullopt;
  const auto count = [&](float side) {
    const float wanted = std::ceil(kVoxelsOfLongestSide * std::fabs(side) / longest);
    return static_cast<std::uint32_t>(std::clamp(wanted, 1.0f, kVoxelsOfLongestSide));
  };
  return std::array{count(sides.x), count(sides.y), count(sides.z)};
}

VoxelGrid CloudDensity::grid(Vec3 from, Vec3 to, const std::array<std::uint32_t, 3>& size) const {
  const Vec3 sides = to - from;
  VoxelGrid grid{.size = size};
  const auto place = [&](int axis, std::uint32_t index) {
    const auto count = static_cast<float>(grid.size[static_cast<std::size_t>(axis)]);
    return from[axis] + sides[axis] * (static_cast<float>(index) + 0.5f) / count;
  };
  grid.values.reserve(grid.voxel_count());
  for (std::uint32_t z = 0; z < grid.size[2]; ++z)
    for (std::uint32_t y = 0; y < grid.size[1]; ++y)
      for (std::uint32_t x = 0; x < grid.size[0]; ++x)
        grid.values.push_back(at({place(0, x), place(1, y), place(2, z)}));
  return grid;
}

}  // namespace tessera::core::pbrt
