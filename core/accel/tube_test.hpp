// SPDX-License-Identifier: Apache-2.0
// Which parts of curves of a packet a ray may hit: those whose tube, an infinite line and a radius, it comes
// near enough to. Rejects most parts whose boxes a ray meets, since hair is thin and boxes are not.
#pragma once

#include <bit>
#include <cstdint>

#include "core/accel/bvh_layout.hpp"
#include "core/geometry/object_ray.hpp"
#include "core/geometry/primitives.hpp"
#include "core/math/simd.hpp"

namespace tessera::core::accel {

// Where a packet keeps the source of a part of a curve.
inline void set_source(BvhPacket& packet, std::uint32_t lane, Curves::Source source) {
  packet.corners[2][1][lane] = std::bit_cast<float>(source.first_point);
  packet.corners[2][2][lane] = std::bit_cast<float>(source.set_and_code);
}
inline Curves::Source source_of(const BvhPacket& packet, std::size_t lane) {
  return {std::bit_cast<std::uint32_t>(packet.corners[2][1][lane]),
          std::bit_cast<std::uint32_t>(packet.corners[2][2][lane])};
}

// Prefetches what tests of the packet's curves read. For packets of curves.
inline void prefetch_curves(const BvhPacket& packet, const Primitives& primitives) {
  for_each_lane(packet.lanes, [&](std::size_t lane) { primitives.prefetch_curve(source_of(packet, lane)); });
}

// A superset of the lanes of curves that are hit. The distance of two lines with directions a and d through
// points that differ by f is |f . (a x d)| / |a x d|. The relative error of the numerator is below 2^-49 of
// |f| |a| |d|; the last term exceeds its square.
inline unsigned curves_near(const BvhPacket& packet, const ObjectRay& ray) {
  const auto load = [&](int corner, int axis) { return DoubleHalf::load(packet.corners[corner][axis]); };
  const auto dot_of = [](const DoubleHalf(&a)[3], const DoubleHalf(&b)[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  };
  const DoubleHalf d[3] = {ray.direction.x, ray.direction.y, ray.direction.z};
  const DoubleHalf start[3] = {load(0, 0), load(0, 1), load(0, 2)};
  const DoubleHalf a[3] = {load(1, 0) - start[0], load(1, 1) - start[1], load(1, 2) - start[2]};
  const DoubleHalf f[3] = {start[0] - DoubleHalf(ray.origin.x), start[1] - DoubleHalf(ray.origin.y),
                           start[2] - DoubleHalf(ray.origin.z)};
  const DoubleHalf n[3] = {a[1] * d[2] - a[2] * d[1], a[2] * d[0] - a[0] * d[2], a[0] * d[1] - a[1] * d[0]};
  const DoubleHalf away = dot_of(f, n), radius = load(2, 0);
  const DoubleHalf error2 = DoubleHalf(0x1p-94) * dot_of(f, f) * dot_of(a, a) * dot_of(d, d);
  return packet.lanes & ~less(radius * radius * dot_of(n, n) + error2, away * away);
}

}  // namespace tessera::core::accel
