// SPDX-License-Identifier: Apache-2.0
// Which parts of curves of a packet a ray may hit: those whose tube, an axis and a radius, it comes near
// enough to. Rejects most parts whose boxes a ray meets, since hair is thin and boxes are not.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "core/accel/bvh_layout.hpp"
#include "core/geometry/object_ray.hpp"
#include "core/geometry/primitives.hpp"
#include "core/math/simd.hpp"

namespace tessera::core::accel {

// Where a packet keeps the tube around a part of a curve, and the part's source.
inline void set_tube(BvhPacket& packet, std::uint32_t lane, const CurveTube& tube) {
  for (int axis = 0; axis < 3; ++axis) {
    packet.corners[0][axis][lane] = tube.start[axis];
    packet.corners[1][axis][lane] = tube.end[axis];
  }
  packet.corners[2][0][lane] = tube.radius;
}
inline void set_source(BvhPacket& packet, std::uint32_t lane, Curves::Source source) {
  packet.corners[2][1][lane] = std::bit_cast<float>(source.first_point);
  packet.corners[2][2][lane] = std::bit_cast<float>(source.set_and_code);
}
inline Curves::Source source_of(const BvhPacket& packet, std::size_t lane) {
  return {std::bit_cast<std::uint32_t>(packet.corners[2][1][lane]),
          std::bit_cast<std::uint32_t>(packet.corners[2][2][lane])};
}

// A superset of the lanes of curves that `ray` hits no farther than `limit`. With the directions a and d of a
// tube's axis and of the ray, through points that differ by f, and n = a x d, the lines are |f . n| / |n|
// apart. The ray is inside of the infinite cylinder along `half` / (|n| |a|) of the axis' projection on
// either side of where the lines come closest. Numbers are relative to |n|^2, so that nothing is divided by
// it. Rounding errors of these are below 2^-48 |a| |d| (|f|^2 + |a|^2)^1/2 for the distance, of which
// `error2` is the square with a reserve, and for ends and depth a share of `half`, which contains the root of
// `error2`.
inline unsigned curves_near(const BvhPacket& packet, const ObjectRay& ray, float limit) {
  using D = DoubleHalf;
  const auto load = [&](int corner, int axis) { return D::load(packet.corners[corner][axis]); };
  const auto dot_of = [](const D(&a)[3], const D(&b)[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  const D d[3] = {ray.direction.x, ray.direction.y, ray.direction.z};
  const D start[3] = {load(0, 0), load(0, 1), load(0, 2)};
  const D a[3] = {load(1, 0) - start[0], load(1, 1) - start[1], load(1, 2) - start[2]};
  const D f[3] = {start[0] - D(ray.origin.x), start[1] - D(ray.origin.y), start[2] - D(ray.origin.z)};
  const D n[3] = {a[1] * d[2] - a[2] * d[1], a[2] * d[0] - a[0] * d[2], a[0] * d[1] - a[1] * d[0]};
  const D away = dot_of(f, n), radius = load(2, 0), n2 = dot_of(n, n);
  const double squared_speed = dot(ray.direction, ray.direction);
  const D dd = squared_speed, aa = dot_of(a, a);
  const D error2 = D(0x1p-80) * (dot_of(f, f) + aa) * aa * dd, away2 = away * away;
  const D near2 = radius * radius * n2 + error2;
  const unsigned lanes = packet.lanes & ~less(near2, away2);
  if (lanes == 0) return 0;
  constexpr double kErrorShare = 0x1p-8;
  const D ad = dot_of(a, d), fa = dot_of(f, a), fd = dot_of(f, d), axis_length = sqrt(aa);
  const D half = sqrt(max(near2 - away2, D(0)) + error2);
  const D middle = D(0.5) * n2, at = fabs(ad * fd - dd * fa - middle);
  const D reach = radius * n2 + half * fabs(ad);
  const D beyond_end = middle + reach / axis_length + D(kErrorShare * std::sqrt(squared_speed)) * half;
  const D depth = aa * fd - ad * fa, inside = D(1 + kErrorShare) * half * axis_length;
  return lanes & ~(less(beyond_end, at) | less(depth + inside, D(0)) | less(D(limit) * n2, depth - inside));
}

}  // namespace tessera::core::accel
