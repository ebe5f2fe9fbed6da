// Rays and what they hit.
#pragma once

#include <cstdint>
#include <limits>

#include "core/math/vec3.hpp"

namespace tessera::core {

// The points origin + t * direction with 0 < t < t_max. The direction need not be of unit length.
struct Ray {
  Vec3 origin, direction;
  float t_max = std::numeric_limits<float>::infinity();
};

inline constexpr std::uint32_t kNoPrimitive = 0xffffffffu;

// The nearest intersection. Where two are equally near, that of the lower primitive id.
struct Hit {
  float t = std::numeric_limits<float>::infinity();
  std::uint32_t primitive = kNoPrimitive;
  float b1 = 0, b2 = 0;  // barycentric coordinates of a triangle's second and third corner; unused by spheres

  bool found() const { return primitive != kNoPrimitive; }

  // Becomes `other` if that lies on the ray and is nearer, or as near with a lower id. Returns whether it
  // did.
  bool improve(const Ray& ray, const Hit& other) {
    if (!(other.t > 0 && other.t < ray.t_max)) return false;
    if (!(other.t < t || (other.t == t && other.primitive < primitive))) return false;
    *this = other;
    return true;
  }
};

}  // namespace tessera::core
