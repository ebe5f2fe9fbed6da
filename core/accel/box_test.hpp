// SPDX-License-Identifier: Apache-2.0
// What every test of rays against boxes agrees on. Distances to slabs are computed with four roundings (Ize
// 2013), and the distance of a hit, otherwise exact to nearly double precision, is rounded once: with a
// factor on the far side no box is missed that holds a hit.
#pragma once

#include <algorithm>
#include <limits>

#include "core/geometry/rounding.hpp"

namespace tessera::core {

inline constexpr float kBoxSlack = 1 + 2 * gamma<float>(6);

// No box that begins beyond this holds a hit before t. Finite, so that boxes beside a ray that is parallel to
// their sides, which begin at infinity, do not count.
inline float box_limit(float t) {
  return std::min(t * kBoxSlack, std::numeric_limits<float>::max());
}

}  // namespace tessera::core
