// SPDX-License-Identifier: Apache-2.0
// Random-looking functions of position, the same on every machine.
#pragma once

#include <cstdint>

#include "core/math/vec3.hpp"

namespace tessera::modelling {

// Evenly distributed in [0, 1), a function of the three numbers.
float random_at(std::int32_t a, std::int32_t b, std::int32_t c);

// Gradient noise (Perlin 1985, with the interpolant of Perlin 2002): smooth, 0 at integer points, within
// [-1.1, 1.1], features about 1 unit wide.
float noise(core::Vec3 p);

// `octaves` layers of noise, each twice as fine and half as strong as the one before. Within [-2.2, 2.2].
float fractal_noise(core::Vec3 p, int octaves);

// Cellular noise (Worley 1996): the distance from p to the nearest of random points, one in each unit cube,
// and that point's own random number in [0, 1).
struct Cell {
  float nearest;
  float random;
};
Cell cellular_noise(core::Vec3 p);

}  // namespace tessera::modelling
