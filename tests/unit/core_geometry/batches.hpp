// SPDX-License-Identifier: Apache-2.0
// Rays that are asked for together, of the kinds that a renderer has, and what they are to find.
#pragma once

#include <cstddef>
#include <vector>

#include "tests/unit/core_geometry/shapes.hpp"

namespace tessera::core::test {

using Rays = std::vector<Ray>;

// `count` rays through neighbouring pixels of a pinhole camera, in blocks of 8 * 8, of `pixel` width on a
// screen at distance 1.
Rays camera_rays(const Soup& soup, Random& random, std::size_t count, float pixel);

// From points of the primitives to points of a small lamp, or from the lamp to them.
Rays lamp_rays(const Soup& soup, Random& random, std::size_t count, bool to_lamp);

Rays random_rays(const Soup& soup, Random& random, std::size_t count);

// Along one axis, from a grid whose points often lie above corners and edges.
Rays parallel_rays(Random& random, std::size_t count);

// The answers of both queries of many rays.
std::vector<Hit> closest_hits(const accel::Bvh& bvh, const Primitives& primitives, const Rays& rays,
                              const accel::HitOpacity* opacity = nullptr);
std::vector<accel::Occlusion> occlusions(const accel::Bvh& bvh, const Primitives& primitives,
                                         const Rays& rays, const accel::HitOpacity* opacity = nullptr);

// kLaneCount rows from `first` on.
WordLanes rows_from(std::size_t first);

// Whether both queries of many rays answer as that of one ray does, bit for bit; a fatal failure if not.
void expect_same_answers(const accel::Bvh& bvh, const Primitives& primitives, const Rays& rays,
                         const accel::HitOpacity* opacity = nullptr);

// The same of rays among which are some that are none, with the number `bad` where it should not be.
void expect_same_answers_beside(float bad, const accel::Bvh& bvh, const Soup& soup, Random& random);

}  // namespace tessera::core::test
