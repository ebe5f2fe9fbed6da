// SPDX-License-Identifier: Apache-2.0
// Tests of one ray against the primitives of a packet that are neither triangles at rest nor instances.
#pragma once

#include <optional>

#include "core/accel/bvh_layout.hpp"
#include "core/accel/moving_triangles.hpp"
#include "core/accel/tube_test.hpp"
#include "core/geometry/primitives.hpp"

namespace tessera::core::accel {

template <typename AnyRay, typename Found>
void for_each_curve_hit(const BvhPacket& packet, const Primitives& primitives, const AnyRay& ray, float limit,
                        const Found& found) {
  const unsigned near = curves_near(packet, ObjectRay(ray), limit);
  for_each_lane(near, [&](std::size_t lane) { primitives.prefetch_curve(source_of(packet, lane)); });
  for_each_lane(near, [&](std::size_t lane) {
    const auto hit = primitives.curve_line_hit(packet.primitives[lane], source_of(packet, lane), ray);
    if (hit) found(*hit);
  });
}

// Calls found(hit) for each hit of the line in front of the origin, wherever the ray ends; hits beyond
// `limit`, a box_limit(), may be left out. Bit-identical to Primitives::intersect().
template <typename AnyRay, typename Found>
void for_each_line_hit(const BvhPacket& packet, const Primitives& primitives, const AnyRay& ray, float limit,
                       const Found& found) {
  switch (packet.kind) {
    case GeometryKind::kTriangle:
    case GeometryKind::kInstance:
      return;
    case GeometryKind::kMovingTriangle:
      return for_each_moving_hit(packet, primitives, ray, found);
    case GeometryKind::kCurve:
      return for_each_curve_hit(packet, primitives, ray, limit, found);
    default:  // by its traits
      for_each_lane(packet.lanes, [&](std::size_t lane) {
        if (const auto hit = primitives.line_hit(packet.kind, packet.primitives[lane], ray)) found(*hit);
      });
  }
}

}  // namespace tessera::core::accel
