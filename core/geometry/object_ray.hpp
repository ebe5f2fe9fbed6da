// SPDX-License-Identifier: Apache-2.0
// A ray in the space of an instanced object. It is in double, so that the transformation's rounding errors
// do not move hits off the object's surface, wherever the object is placed.
#pragma once

#include <limits>

#include "core/geometry/ray.hpp"
#include "core/geometry/vec3d.hpp"

namespace tessera::core {

// As Ray. t is the same along both, since the direction is not normalised.
struct ObjectRay {
  ObjectRay(Vec3d origin_value, Vec3d direction_value, float t_max_value, float time_value = 0)
      : origin(origin_value), direction(direction_value), t_max(t_max_value), time(time_value) {}
  // Converts a ray that is in object space already.
  explicit ObjectRay(const Ray& ray)
      : origin(ray.origin), direction(ray.direction), t_max(ray.t_max), time(ray.time) {}

  Vec3d origin, direction;
  float t_max, time;
};

}  // namespace tessera::core
