// Up to 64 rays by coordinate, so that eight are computed with at once. Where eight are not full, the last
// ray is repeated.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include "core/geometry/object_ray.hpp"
#include "core/geometry/ray.hpp"
#include "core/math/simd_double8.hpp"

namespace tessera::core {

// A set of a group's rays: bit i for ray i.
using RaySet = std::uint64_t;

// A coordinate of a ray, and eight of them.
template <typename AnyRay>
struct RayNumbers;
template <>
struct RayNumbers<Ray> {
  using Real = float;
  using Lanes = Float8;
};
template <>
struct RayNumbers<ObjectRay> {
  using Real = double;
  using Lanes = Double8;
};

inline constexpr std::size_t kGroupSize = 64;

// Of Rays, or of ObjectRays.
template <typename AnyRay>
struct RayColumns {
  static constexpr std::size_t kSize = kGroupSize, kLanes = 8, kVectors = kSize / kLanes;
  using Real = typename RayNumbers<AnyRay>::Real;
  using Lanes = typename RayNumbers<AnyRay>::Lanes;

  // ray_at(i) becomes ray i. There is at least one.
  template <typename RayAt>
  RayColumns(std::size_t ray_count, const RayAt& ray_at) : count(ray_count) {
    for (std::size_t i = 0; i < kLanes * vectors(); ++i) {
      const AnyRay& ray = ray_at(std::min(i, count - 1));
      origin[0][i] = ray.origin.x, origin[1][i] = ray.origin.y, origin[2][i] = ray.origin.z;
      direction[0][i] = ray.direction.x, direction[1][i] = ray.direction.y, direction[2][i] = ray.direction.z;
      t_max[i] = ray.t_max;
    }
  }

  RaySet all() const { return count == kSize ? ~RaySet{0} : (RaySet{1} << count) - 1; }
  // Eights that there are rays in.
  std::size_t vectors() const { return (count + kLanes - 1) / kLanes; }
  AnyRay ray(std::size_t i) const {
    return {{origin[0][i], origin[1][i], origin[2][i]},
            {direction[0][i], direction[1][i], direction[2][i]},
            t_max[i]};
  }

  std::size_t count;
  alignas(32) Real origin[3][kSize];
  alignas(32) Real direction[3][kSize];
  alignas(32) float t_max[kSize];
};

// Those of a set that are in a vector of eight.
inline unsigned lanes_of(RaySet set, std::size_t vector) {
  return static_cast<unsigned>(set >> (8 * vector)) & 0xffu;
}
inline RaySet to_set(unsigned lanes, std::size_t vector) {
  return RaySet{lanes} << (8 * vector);
}
inline int vectors_of(RaySet set) {
  int vectors = 0;
  for (std::size_t v = 0; v < kGroupSize / 8; ++v) vectors += lanes_of(set, v) != 0;
  return vectors;
}
// Calls what(i) for each ray.
template <typename What>
void for_each_ray(RaySet set, const What& what) {
  for (; set != 0; set &= set - 1) what(static_cast<std::size_t>(std::countr_zero(set)));
}

// The octant that a direction points into: bit i is the sign of coordinate i.
inline unsigned octant(const Ray& ray) {
  const auto sign = [](float x) { return std::bit_cast<std::uint32_t>(x) >> 31; };
  return sign(ray.direction.x) | sign(ray.direction.y) << 1 | sign(ray.direction.z) << 2;
}

// Lanes in the other precision, where that is not theirs already.
inline Float8 in_float(Float8 a) {
  return a;
}
inline Float8 in_float(Double8 a) {
  return to_float(a);
}
inline Double8 in_double(Float8 a) {
  return widened(a);
}
inline Double8 in_double(Double8 a) {
  return a;
}

}  // namespace tessera::core
