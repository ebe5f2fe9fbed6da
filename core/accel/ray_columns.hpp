// SPDX-License-Identifier: Apache-2.0
// Up to 64 rays as a structure of arrays, so that a vector of them is processed at once. The last ray fills
// up an incomplete vector.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/geometry/object_ray.hpp"
#include "core/geometry/ray.hpp"
#include "core/math/simd_widest.hpp"

namespace tessera::core {

// A set of a group's rays: bit i for ray i.
using RaySet = std::uint64_t;

// The scalar type of a ray's coordinates, and the vector type.
template <typename AnyRay>
struct RayNumbers;
template <>
struct RayNumbers<Ray> {
  using Real = float;
  using Lanes = FloatVector;
};
template <>
struct RayNumbers<ObjectRay> {
  using Real = double;
  using Lanes = DoubleVector;
};

inline constexpr std::size_t kGroupSize = 64;

// AnyRay is Ray or ObjectRay.
template <typename AnyRay>
struct RayColumns {
  static constexpr std::size_t kSize = kGroupSize, kLanes = kVectorLanes, kVectors = kSize / kLanes;
  using Real = typename RayNumbers<AnyRay>::Real;
  using Lanes = typename RayNumbers<AnyRay>::Lanes;

  // ray_at(i) returns ray i (for Ray, a reference). There is at least one ray.
  template <typename RayAt>
  RayColumns(std::size_t ray_count, const RayAt& ray_at) : count(ray_count) {
    const std::size_t padded = (count + kMaxVectorLanes - 1) / kMaxVectorLanes * kMaxVectorLanes;
    for (std::size_t i = 0; i < padded; i += 8)
      set_vector(i, [&](std::size_t k) -> decltype(auto) { return ray_at(std::min(i + k, count - 1)); });
  }

  RaySet all() const { return count == kSize ? ~RaySet{0} : (RaySet{1} << count) - 1; }
  // The number of vectors that contain rays.
  std::size_t vectors() const { return (count + kLanes - 1) / kLanes; }
  AnyRay ray(std::size_t i) const {
    return {{origin[0][i], origin[1][i], origin[2][i]},
            {direction[0][i], direction[1][i], direction[2][i]},
            t_max[i],
            time[i]};
  }

  std::size_t count;
  alignas(kVectorAlignment) Real origin[3][kSize];
  alignas(kVectorAlignment) Real direction[3][kSize];
  alignas(kVectorAlignment) float t_max[kSize];
  alignas(kVectorAlignment) float time[kSize];

 private:
  template <typename RayAt>
  void set_vector(std::size_t first, const RayAt& ray_at) {
    if constexpr (std::is_same_v<AnyRay, Ray>) {
      static_assert(std::is_lvalue_reference_v<decltype(ray_at(0))>);
      // Loads rows of four numbers.
      static_assert(offsetof(Ray, direction) == 3 * sizeof(float) && sizeof(Ray) == 8 * sizeof(float));
      const auto rows = [&](std::size_t offset) {
        return transposed([&](std::size_t k) { return reinterpret_cast<const float*>(&ray_at(k)) + offset; });
      };
      const auto [x, y, z, dx] = rows(0);
      const auto [dy, dz, t, when] = rows(4);
      x.store(origin[0] + first), y.store(origin[1] + first), z.store(origin[2] + first);
      dx.store(direction[0] + first), dy.store(direction[1] + first), dz.store(direction[2] + first);
      t.store(t_max + first), when.store(time + first);
    } else {
      for (std::size_t k = 0; k < 8; ++k) {
        const AnyRay& ray = ray_at(k);
        const std::size_t i = first + k;
        origin[0][i] = ray.origin.x, origin[1][i] = ray.origin.y, origin[2][i] = ray.origin.z;
        direction[0][i] = ray.direction.x, direction[1][i] = ray.direction.y,
        direction[2][i] = ray.direction.z;
        t_max[i] = ray.t_max, time[i] = ray.time;
      }
    }
  }
};

// The lanes of `vector` that are in `set`.
inline unsigned lanes_of(RaySet set, std::size_t vector) {
  constexpr unsigned kAll = (1u << kVectorLanes) - 1;
  return static_cast<unsigned>(set >> (kVectorLanes * vector)) & kAll;
}
inline RaySet to_set(unsigned lanes, std::size_t vector) {
  return RaySet{lanes} << (kVectorLanes * vector);
}
inline int vectors_of(RaySet set) {
  int vectors = 0;
  for (std::size_t v = 0; v < kGroupSize / kVectorLanes; ++v) vectors += lanes_of(set, v) != 0;
  return vectors;
}
// Calls what(i) for each ray.
template <typename What>
void for_each_ray(RaySet set, const What& what) {
  for (; set != 0; set &= set - 1) what(static_cast<std::size_t>(std::countr_zero(set)));
}

// The octant that a direction points into: bit i is the sign of coordinate i.
inline unsigned octant(const Ray& ray) {
  static_assert(offsetof(Ray, t_max) == offsetof(Ray, direction) + 3 * sizeof(float));  // the fourth
  return signs_of_four(&ray.direction.x) & 7u;
}

// Converts lanes to the other precision if necessary.
inline FloatVector in_float(FloatVector a) {
  return a;
}
inline FloatVector in_float(DoubleVector a) {
  return to_float(a);
}
inline DoubleVector in_double(FloatVector a) {
  return widened(a);
}
inline DoubleVector in_double(DoubleVector a) {
  return a;
}

}  // namespace tessera::core
