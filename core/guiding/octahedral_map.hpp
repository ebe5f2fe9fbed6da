// The unit sphere unfolded to the unit square by way of an octahedron (Meyer et al. 2010), which takes no
// trigonometry. Neighbours stay neighbours but at the square's rim.
#pragma once

#include <cmath>

#include "core/math/vec3.hpp"

namespace tessera::core {

// What a density on the square is to be divided by for the density per solid angle at `direction`, which is
// of unit length. A face of the octahedron at distance r from the centre is seen foreshortened by 1 / r and
// smaller by 1 / r^2, and 1 / r is the sum of the direction's coordinates without their signs.
inline float octahedral_area(Vec3 direction) {
  const Vec3 a = abs(direction);
  const float sum = a.x + a.y + a.z;
  return 4 * sum * sum * sum;
}

// In [0, 1] x [0, 1].
inline Vec2 to_octahedral_square(Vec3 direction) {
  const Vec3 a = abs(direction);
  const float scale = 1 / (a.x + a.y + a.z);
  const float x = a.x * scale, y = a.y * scale;
  const bool upper = direction.z >= 0;
  const float folded_x = std::copysign(upper ? x : 1 - y, direction.x);
  const float folded_y = std::copysign(upper ? y : 1 - x, direction.y);
  return {0.5f + 0.5f * folded_x, 0.5f + 0.5f * folded_y};
}

inline Vec3 from_octahedral_square(Vec2 point) {
  const float x = 2 * point.x - 1, y = 2 * point.y - 1, z = 1 - std::fabs(x) - std::fabs(y);
  if (z >= 0) return normalize({x, y, z});
  return normalize({std::copysign(1 - std::fabs(y), x), std::copysign(1 - std::fabs(x), y), z});
}

}  // namespace tessera::core
