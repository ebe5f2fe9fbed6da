// SPDX-License-Identifier: Apache-2.0
// The octahedral map of the unit sphere to the unit square (Meyer et al. 2010), without trigonometry. It is
// continuous except at the square's boundary.
#pragma once

#include <cmath>

#include "core/math/vec3.hpp"

namespace tessera::core {

// The Jacobian: divide a density on the square by it for the density per solid angle at the unit vector
// `direction`. A face of the octahedron at distance r from the centre is foreshortened by 1 / r and reduced
// by 1 / r^2, and 1 / r is the sum of the absolute coordinates.
template <typename T = float>
T octahedral_area(Vec3Of<T> direction) {
  const Vec3Of<T> a = abs(direction);
  const T sum = a.x + a.y + a.z;
  return 4 * sum * sum * sum;
}

// Results are in [0, 1] x [0, 1].
template <typename T = float>
Vec2Of<T> to_octahedral_square(Vec3Of<T> direction) {
  using std::copysign;
  const Vec3Of<T> a = abs(direction);
  const T scale = 1 / (a.x + a.y + a.z);
  const T x = a.x * scale, y = a.y * scale;
  const MaskOf<T> upper = direction.z >= 0;
  const T folded_x = copysign(select(upper, x, 1 - y), direction.x);
  const T folded_y = copysign(select(upper, y, 1 - x), direction.y);
  return {0.5f + 0.5f * folded_x, 0.5f + 0.5f * folded_y};
}

template <typename T = float>
Vec3Of<T> from_octahedral_square(Vec2Of<T> point) {
  using std::copysign, std::fabs;
  const T x = 2 * point.x - 1, y = 2 * point.y - 1, z = 1 - fabs(x) - fabs(y);
  const MaskOf<T> upper = z >= 0;
  const Vec3Of<T> on_octahedron{select(upper, x, copysign(1 - fabs(y), x)),
                                select(upper, y, copysign(1 - fabs(x), y)), z};
  return on_octahedron * (1 / length(on_octahedron));
}

}  // namespace tessera::core
