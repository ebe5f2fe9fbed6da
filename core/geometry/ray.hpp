// SPDX-License-Identifier: Apache-2.0
// Rays and hits.
#pragma once

#include <cstdint>
#include <limits>

#include "core/math/vec3.hpp"

namespace tessera::core {

// The points origin + t * direction with 0 < t < t_max. The direction need not have unit length.
template <typename T>
struct RayOf {
  Vec3Of<T> origin, direction;
  T t_max = std::numeric_limits<float>::infinity();
  T time = 0.0f;  // from 0, when the shutter opens, to 1, when it closes
};
using Ray = RayOf<float>;

inline constexpr std::uint32_t kNoPrimitive = 0xffffffffu;
inline constexpr std::uint32_t kNoInstance = 0xffffffffu;

// The nearest intersection. Ties are resolved in favour of hits outside instances, then of the lower
// instance index, then of the lower primitive id.
struct Hit {
  float t = std::numeric_limits<float>::infinity();
  std::uint32_t primitive = kNoPrimitive;  // within an instance: an id of its object
  // Barycentric coordinates of a triangle's second and third corner; CurveHit's u and across; else unused.
  float b1 = 0, b2 = 0;
  std::uint32_t instance = kNoInstance;
  float time = 0;  // the ray's, where instances move

  bool found() const { return primitive != kNoPrimitive; }
  bool in_instance() const { return instance != kNoInstance; }

  // Becomes `other` if that lies on the ray and is nearer, or equally near with a lower rank. Returns
  // whether it did.
  template <typename AnyRay>
  bool improve(const AnyRay& ray, const Hit& other) {
    if (!(other.t > 0 && other.t < ray.t_max)) return false;
    if (!(other.t < t || (other.t == t && other.rank() < rank()))) return false;
    *this = other;
    return true;
  }

 private:
  // Hits outside instances rank first, because kNoInstance + 1 is 0.
  std::uint64_t rank() const {
    return std::uint64_t{static_cast<std::uint32_t>(instance + 1)} << 32 | primitive;
  }
};

}  // namespace tessera::core
