// SPDX-License-Identifier: Apache-2.0
// Boxes as the tree builder handles them: a vector of floats with the lower corner negated, so that one
// maximum unites two boxes.
#pragma once

#include <bit>
#include <cstdint>
#include <limits>

#include "core/geometry/aabb.hpp"
#include "core/math/simd_halves.hpp"

namespace tessera::core::accel {

// The lanes are -x, -y, -z of the lower corner, an unused lane, x, y, z of the upper corner, an unused
// lane. A default-constructed box is empty.
struct BuildBox {
  FloatN v = FloatN::broadcast(-std::numeric_limits<float>::infinity());

  void include(BuildBox other) { v = max(v, other.v); }
  // Half of the centre, as a box: a quarter of the sum of both corners, which cannot overflow. The box must
  // not be empty.
  BuildBox half_centroid() const {
    const FloatN quarter = v * FloatN::broadcast(0.25f);
    return {quarter - with_halves_swapped(quarter)};
  }
  Aabb box() const {
    alignas(32) float lanes[8];
    v.store(lanes);
    return {{-lanes[0], -lanes[1], -lanes[2]}, {lanes[4], lanes[5], lanes[6]}};
  }
};

// A primitive to be put into the tree: its box, with the primitive's id in the fourth lane.
struct alignas(32) BuildItem {
  float lanes[8];

  BuildItem(const Aabb& box, std::uint32_t primitive)
      : lanes{-box.lower.x, -box.lower.y, -box.lower.z, std::bit_cast<float>(primitive),
              box.upper.x,  box.upper.y,  box.upper.z,  0} {}

  std::uint32_t primitive() const { return std::bit_cast<std::uint32_t>(lanes[3]); }
  // The box without the id. Read as a float the id is usually denormal, which slows down arithmetic.
  BuildBox box() const { return {without_lane_3(FloatN::load(lanes))}; }
};

// The bounds of a range of items: of their boxes, and of their half centroids.
struct RangeBounds {
  BuildBox boxes, half_centroids;

  void include(BuildBox box) {
    boxes.include(box);
    half_centroids.include(box.half_centroid());
  }
  void include(const RangeBounds& other) {
    boxes.include(other.boxes);
    half_centroids.include(other.half_centroids);
  }
};

}  // namespace tessera::core::accel
