// SPDX-License-Identifier: Apache-2.0
// Triangle soups of typical scenes, and the rays of a path tracer in them, for the benchmarks of the
// acceleration structure.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/accel/bvh.hpp"
#include "core/geometry/primitives.hpp"

namespace tessera::core {

struct Soup {
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  Vec3 eye, look_at;
  Sphere lamp;

  Primitives primitives() const;
};

// A bumpy sphere of about 4 * rows^2 triangles on a plane of two.
Soup blob_on_plane(int rows);

// side * side such blobs, rotated and of different sizes, without a plane.
Soup blobs(int side, int rows);

// The same on a plane.
Soup blob_field(int side, int rows);

// 182 stones on a board of 19 lines, seen from a player's chair: 133,000 triangles, most of them tiny and
// some as large as the scene.
Soup go_board();

// 15,000 strands of hair on a ball above the ground: 300,000 long and thin triangles at all angles, whose
// boxes overlap strongly.
Soup strands();

// The same strands as curves: 150,000 segments.
CurveStrands strand_curves();

// The same above a plane.
Soup strands_on_plane();

struct RaySets {
  std::vector<Ray> primary;  // from a pinhole, side * side pixels in blocks of 8 * 8
  std::vector<Ray> bounce;   // one from each primary hit, cosine-distributed
  std::vector<Ray> shadow;   // one from each primary hit to a point of the lamp's surface, 0 < t < 1
};

RaySets make_rays(const Soup& soup, const Primitives& primitives, const accel::Bvh& bvh, int side);

}  // namespace tessera::core
