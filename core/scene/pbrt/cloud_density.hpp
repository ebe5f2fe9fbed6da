// SPDX-License-Identifier: Apache-2.0
// The density of pbrt's medium "cloud", as a grid.
#pragma once

#include <optional>

#include "core/math/vec3.hpp"
#include "core/media/voxel_grid.hpp"

namespace tessera::core::pbrt {

// The density from 0 to 1 is computed from noise (Pharr et al. 2023, section 11.4.6), and falls off between
// the heights y = 0.5 and y = 1 of the medium's space.
struct CloudDensity {
  float density = 1, wispiness = 1, frequency = 5;

  float at(Vec3 point) const;
  // The values at the centres of voxels that fill the box between two corners, as cubical as they can be.
  // nullopt if they are one point, or not finite.
  std::optional<VoxelGrid> grid(Vec3 from, Vec3 to) const;
};

}  // namespace tessera::core::pbrt
