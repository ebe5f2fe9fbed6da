// SPDX-License-Identifier: Apache-2.0
// The light of hot media: pbrt's grids of temperatures.
#pragma once

#include "core/media/voxel_grid.hpp"

namespace tessera::core::pbrt {

// From the values of a grid to kelvin: (value - offset) * scale.
struct TemperatureUnits {
  float offset = 0, scale = 1;
};

// The colours of black bodies (Planck 1901) that have a radiance of 1 where their spectrum is brightest, as
// pbrt scales them; nothing up to 100 K. `temperatures` has one channel.
VoxelGrid black_bodies(const VoxelGrid& temperatures, const TemperatureUnits& units);

}  // namespace tessera::core::pbrt
