// SPDX-License-Identifier: Apache-2.0
// Looks up the grids of procedural textures. Stateless; thread-safe.
#pragma once

#include "core/math/simd_double.hpp"
#include "core/math/vec3.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

// The value at a point, one or in each lane, trilinear between the centres of voxels or that of the nearest
// one. `image` holds the grid's layers. Coordinates that are no numbers count as 0.
Rgb grid_value(const GridPattern& grid, const TextureImage& image, Vec3 p);
RgbOf<FloatN> grid_value(const GridPattern& grid, const TextureImage& image, Vec3Of<FloatN> p);

}  // namespace tessera::core
