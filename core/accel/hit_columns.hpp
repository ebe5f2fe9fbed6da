// SPDX-License-Identifier: Apache-2.0
// The hits of a group's rays as a structure of arrays, so that many are set or stored at once.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "core/accel/ray_columns.hpp"
#include "core/geometry/ray.hpp"
#include "core/math/columns.hpp"

namespace tessera::core::accel {

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

  // Stores the hit of ray i in hits[order[i]]; the order is ascending. Times are left alone.
  void store(std::span<const std::uint16_t> order, ColumnsView<Hit> hits) const {
    float *const t = hits.field(&Hit::t).column(0), *const primitive = hits.field(&Hit::primitive).column(0),
                 *const b1 = hits.field(&Hit::b1).column(0), *const b2 = hits.field(&Hit::b2).column(0),
                 *const instance = hits.field(&Hit::instance).column(0);
    if (order.back() - order.front() + std::size_t{1} == order.size()) {
      const std::size_t first = order.front(), bytes = order.size() * sizeof(float);
      std::memcpy(t + first, t_, bytes);
      std::memcpy(primitive + first, primitive_, bytes);
      std::memcpy(b1 + first, b1_, bytes);
      std::memcpy(b2 + first, b2_, bytes);
      std::memcpy(instance + first, instance_, bytes);
      return;
    }
    for (std::size_t i = 0; i < order.size(); ++i) {
      const std::size_t row = order[i];
      t[row] = t_[i], b1[row] = b1_[i], b2[row] = b2_[i];
      primitive[row] = std::bit_cast<float>(primitive_[i]);
      instance[row] = std::bit_cast<float>(instance_[i]);
    }
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

}  // namespace tessera::core::accel
