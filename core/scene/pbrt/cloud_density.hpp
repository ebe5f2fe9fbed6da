// SPDX-License-Identifier: Apache-2.0
// The density of pbrt's medium "cloud", as a grid.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/math/vec3.hpp"
#include "core/media/voxel_grid.hpp"

namespace tessera::core::pbrt {

// The density from 0 to 1 is computed from noise (Pharr et al. 2023, section 11.4.6). It is 1 up to y = 0 of
// the medium's space, at least that of a fall to 0 at y = 0.5, and noise above.
struct CloudDensity {
  float density = 1, wispiness = 1, frequency = 5;

  float at(Vec3 point) const;
  // How many voxels fill the box between two corners, as cubical as they can be; nullopt if the corners are
  // one point, or not finite.
  static std::optional<std::array<std::uint32_t, 3>> grid_size(Vec3 from, Vec3 to);
  // The values at the centres of that many voxels.
  VoxelGrid grid(Vec3 from, Vec3 to, const std::array<std::uint32_t, 3>& size) const;
};

}  // namespace tessera::core::pbrt
