// SPDX-License-Identifier: Apache-2.0
// Up to 64 rays as a structure of arrays, so that a vector of them is processed at once. The last ray fills
// up an incomplete vector.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/geometry/object_ray.hpp"
#include "core/geometry/ray.hpp"
#include "core/math/columns.hpp"
#include "core/math/simd_widest.hpp"

namespace tessera::core::accel {

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

  // ray_at(i) returns ray i. There is at least one ray.
  template <typename RayAt>
  RayColumns(std::size_t ray_count, const RayAt& ray_at) : count(ray_count) {
    for (std::size_t i = 0; i < padded(); ++i) set(i, ray_at(std::min(i, count - 1)));
  }
  // Rays rays[order[0]] and so on, in ascending order. Their times are needed if they are `timed`, else
  // they are 0.
  RayColumns(ColumnsView<const Ray> rays, std::span<const std::uint16_t> order, bool timed)
      : count(order.size()) {
    const ColumnsView<const Vec3> origins = rays.field(&Ray::origin),
                                  directions = rays.field(&Ray::direction);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      copy(origins.column(axis), order, origin[axis]);
      copy(directions.column(axis), order, direction[axis]);
    }
    copy(rays.field(&Ray::t_max).column(0), order, t_max);
    if (timed) {
      copy(rays.field(&Ray::time).column(0), order, time);
    } else {
      for (std::size_t i = 0; i < padded(); i += kLaneCount) FloatN(0.0f).store(time + i);
    }
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
  std::size_t padded() const { return (count + kMaxVectorLanes - 1) / kMaxVectorLanes * kMaxVectorLanes; }

  void set(std::size_t i, const AnyRay& ray) {
    origin[0][i] = ray.origin.x, origin[1][i] = ray.origin.y, origin[2][i] = ray.origin.z;
    direction[0][i] = ray.direction.x, direction[1][i] = ray.direction.y, direction[2][i] = ray.direction.z;
    t_max[i] = ray.t_max, time[i] = ray.time;
  }

  // Numbers that are together in the column are read a vector at a time.
  void copy(const float* column, std::span<const std::uint16_t> order, float* to) const {
    std::size_t i = 0;
    if (order.back() - order.front() + std::size_t{1} == count) {
      for (const float* from = column + order.front(); i + kLaneCount <= count; i += kLaneCount)
        FloatN::load_unaligned(from + i).store(to + i);
    } else {
      for (; i + kLaneCount <= count; i += kLaneCount)
        FloatN::gather(column, U32xN::load_shorts(&order[i]).v).store(to + i);
    }
    for (; i < count; ++i) to[i] = column[order[i]];
    std::fill(to + count, to + padded(), to[count - 1]);
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

}  // namespace tessera::core::accel
