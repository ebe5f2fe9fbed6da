// SPDX-License-Identifier: Apache-2.0
// A ray in the space of an object that instances show. It is in double: what takes a ray there rounds so
// little that an object is hit where its surface is, and again where a ray left it, wherever it is placed.
#pragma once

#include <limits>

#include "core/geometry/ray.hpp"
#include "core/geometry/vec3d.hpp"

namespace tessera::core {

// As Ray. t is the same along both, since the direction is not brought to unit length.
struct ObjectRay {
  ObjectRay(Vec3d origin_value, Vec3d direction_value, float t_max_value)
      : origin(origin_value), direction(direction_value), t_max(t_max_value) {}
  // Of what is in its own space already.
  explicit ObjectRay(const Ray& ray) : origin(ray.origin), direction(ray.direction), t_max(ray.t_max) {}

  Vec3d origin, direction;
  float t_max;
};

}  // namespace tessera::core
