// SPDX-License-Identifier: Apache-2.0
// The hits of a group's rays as a structure of arrays, so that many are set or stored at once.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/accel/ray_columns.hpp"
#include "core/geometry/ray.hpp"

namespace tessera::core {

class HitColumns {
 public:
  // Initially nothing is hit.
  HitColumns() {
    const Hit nothing;
    std::fill_n(t_, kGroupSize, nothing.t);
    std::fill_n(primitive_, kGroupSize, nothing.primitive);
    std::fill_n(b1_, kGroupSize, nothing.b1);
    std::fill_n(b2_, kGroupSize, nothing.b2);
    std::fill_n(instance_, kGroupSize, nothing.instance);
  }

  Hit operator[](std::size_t i) const { return {t_[i], primitive_[i], b1_[i], b2_[i], instance_[i]}; }
  float t(std::size_t i) const { return t_[i]; }
  bool found(std::size_t i) const { return primitive_[i] != kNoPrimitive; }
  void set(std::size_t i, const Hit& hit) {
    t_[i] = hit.t, primitive_[i] = hit.primitive, b1_[i] = hit.b1, b2_[i] = hit.b2;
    instance_[i] = hit.instance;
  }

  // Stores the hit of ray i in hits[order[i]].
  void store(std::span<const std::uint16_t> order, std::span<Hit> hits) const {
    static_assert(offsetof(Hit, primitive) == sizeof(float) && offsetof(Hit, b1) == 2 * sizeof(float) &&
                  offsetof(Hit, b2) == 3 * sizeof(float) && offsetof(Hit, instance) == 4 * sizeof(float));
    std::size_t i = 0;
    for (; i + 4 <= order.size(); i += 4) {
      const auto row = [&](std::size_t k) { return &hits[order[i + k]].t; };
      store_transposed({t_ + i, reinterpret_cast<const float*>(primitive_ + i), b1_ + i, b2_ + i}, row);
      for (std::size_t k = 0; k < 4; ++k) hits[order[i + k]].instance = instance_[i + k];
    }
    for (; i < order.size(); ++i) hits[order[i]] = (*this)[i];
  }

  // The storage of the hits of rays from `first` on.
  struct Places {
    float *t, *b1, *b2;
    std::uint32_t *primitive, *instance;
  };
  Places from(std::size_t first) {
    return {t_ + first, b1_ + first, b2_ + first, primitive_ + first, instance_ + first};
  }

 private:
  alignas(kVectorAlignment) float t_[kGroupSize];
  alignas(kVectorAlignment) float b1_[kGroupSize];
  alignas(kVectorAlignment) float b2_[kGroupSize];
  alignas(kVectorAlignment) std::uint32_t primitive_[kGroupSize];
  alignas(kVectorAlignment) std::uint32_t instance_[kGroupSize];
};

}  // namespace tessera::core
