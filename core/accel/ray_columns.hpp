// Up to 64 rays by coordinate, so that eight are computed with at once; those that are missing repeat the
// last.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>

#include "core/geometry/ray.hpp"

namespace tessera::core {

// A set of a group's rays: bit i for ray i.
using RaySet = std::uint64_t;

struct RayColumns {
  static constexpr std::size_t kSize = 64, kLanes = 8, kVectors = kSize / kLanes;

  // rays[order[i]] becomes ray i.
  RayColumns(std::span<const Ray> rays, std::span<const std::uint32_t> order) : count(order.size()) {
    for (std::size_t i = 0; i < kSize; ++i) {
      const Ray& ray = rays[order[std::min(i, count - 1)]];
      origin[0][i] = ray.origin.x, origin[1][i] = ray.origin.y, origin[2][i] = ray.origin.z;
      direction[0][i] = ray.direction.x, direction[1][i] = ray.direction.y, direction[2][i] = ray.direction.z;
      t_max[i] = ray.t_max;
    }
  }

  RaySet all() const { return count == kSize ? ~RaySet{0} : (RaySet{1} << count) - 1; }

  std::size_t count;
  alignas(32) float origin[3][kSize];
  alignas(32) float direction[3][kSize];
  alignas(32) float t_max[kSize];
};

// Those of a set that are in a vector of eight.
inline unsigned lanes_of(RaySet set, std::size_t vector) {
  return static_cast<unsigned>(set >> (RayColumns::kLanes * vector)) & 0xffu;
}
inline RaySet to_set(unsigned lanes, std::size_t vector) {
  return RaySet{lanes} << (RayColumns::kLanes * vector);
}
inline int vectors_of(RaySet set) {
  int vectors = 0;
  for (std::size_t v = 0; v < RayColumns::kVectors; ++v) vectors += lanes_of(set, v) != 0;
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

}  // namespace tessera::core
