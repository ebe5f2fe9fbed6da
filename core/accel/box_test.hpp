// SPDX-License-Identifier: Apache-2.0
// Conventions shared by all ray-box tests. Distances to slabs are computed with four roundings (Ize 2013),
// and the distance of a hit, otherwise exact to nearly double precision, is rounded once. Scaling the far
// distance by a factor guarantees that no box that contains a hit is missed.
#pragma once

#include <algorithm>
#include <limits>

#include "core/geometry/rounding.hpp"

namespace tessera::core {

inline constexpr float kBoxSlack = 1 + 2 * gamma<float>(6);

// Boxes that begin beyond this distance hold no hit before t. The limit is finite, so that boxes beside a
// ray parallel to their sides, which begin at infinity, are rejected.
inline float box_limit(float t) {
  return std::min(t * kBoxSlack, std::numeric_limits<float>::max());
}

}  // namespace tessera::core
