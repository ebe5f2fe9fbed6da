// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/sphere.hpp"

namespace tessera::core {

Tangents sphere_tangents(Vec3 normal) {
  const Vec3 east{normal.z, 0, -normal.x};  // +y x normal
  const float equatorial = length(east);
  if (!(equatorial > 0)) return {};
  return {east / equatorial, cross(normal, east / equatorial)};
}

}  // namespace tessera::core
