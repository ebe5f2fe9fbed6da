// SPDX-License-Identifier: Apache-2.0
// Tests of a ray against the moving triangles of a packet, which it reads where they are at its time.
#pragma once

#include <bit>

#include "core/accel/bvh_layout.hpp"
#include "core/accel/triangle_hits.hpp"
#include "core/geometry/primitives.hpp"
#include "core/math/simd.hpp"

namespace tessera::core::accel {

// Calls found(hit) for each hit of the line in front of the origin, wherever the ray ends. Bit-identical to
// Primitives::intersect().
template <typename AnyRay, typename Found>
void for_each_moving_hit(const BvhPacket& packet, const Primitives& primitives, const AnyRay& ray,
                         const Found& found) {
  TriangleCorners triangles[BvhPacket::kWidth];
  alignas(16) float corners[3][3][BvhPacket::kWidth] = {};
  for (unsigned lanes = packet.lanes; lanes != 0; lanes &= lanes - 1) {
    const int lane = std::countr_zero(lanes);
    triangles[lane] = primitives.triangle_corners(packet.primitives[lane], ray.time);
    for (std::size_t corner = 0; corner < 3; ++corner)
      for (int axis = 0; axis < 3; ++axis) corners[corner][axis][lane] = triangles[lane][corner][axis];
  }
  const ShearedRay sheared(ray);
  const TriangleHitsOf<DoubleHalf> hits(ShearedRaysOf<DoubleHalf>(sheared), [&](int corner, int axis) {
    return DoubleHalf::load(corners[corner][sheared.axis(axis)]);
  });
  for (unsigned lanes = hits.lanes() & packet.lanes; lanes != 0; lanes &= lanes - 1) {
    const int lane = std::countr_zero(lanes);
    if (can_be_hit(triangles[lane]))
      found(Hit{hits.t(lane), packet.primitives[lane], hits.b1(lane), hits.b2(lane), kNoInstance, ray.time});
  }
}

}  // namespace tessera::core::accel
