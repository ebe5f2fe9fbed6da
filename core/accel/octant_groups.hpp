// SPDX-License-Identifier: Apache-2.0
// Sorts the rays of a batch query into groups that point into one octant (group_traversal.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/accel/ray_columns.hpp"
#include "core/base/prefetch.hpp"
#include "core/geometry/ray.hpp"
#include "core/math/columns.hpp"

namespace tessera::core::accel {

// Rays are sorted by octant within runs of at most this many.
inline constexpr std::size_t kRun = 512;
// Smaller groups are not worth the setup cost.
inline constexpr std::size_t kMinGroup = 8;

// The octants that the rays of a run point into: bit i is the sign of coordinate i of the direction.
class Octants {
 public:
  explicit Octants(ColumnsView<const Ray> run) : directions_(run.field(&Ray::direction)) {}

  // Whether rays begin to begin + count are of one octant.
  bool is_one(std::size_t begin, std::size_t count) const {
    return have_one_sign(directions_.column(0) + begin, count) &&
           have_one_sign(directions_.column(1) + begin, count) &&
           have_one_sign(directions_.column(2) + begin, count);
  }
  // Finds the octants of these rays.
  void find(std::size_t begin, std::size_t count) {
    std::size_t i = begin;
    for (; i + kLaneCount <= begin + count; i += kLaneCount) {
      const auto negative = [&](std::size_t axis) {
        return as_bits(FloatN::load_unaligned(directions_.column(axis) + i)) >> 31;
      };
      (negative(0) | negative(1) << 1 | negative(2) << 2).store(&found_[i]);
    }
    const auto negative = [&](std::size_t axis) { return as_bits(directions_.column(axis)[i]) >> 31; };
    for (; i < begin + count; ++i) found_[i] = negative(0) | negative(1) << 1 | negative(2) << 2;
  }
  // Of a ray whose octant was found.
  std::uint32_t operator[](std::size_t i) const { return found_[i]; }

 private:
  static bool have_one_sign(const float* numbers, std::size_t count) {
    std::size_t i = 0;
    U32xN any_negative(0u), all_negative(~0u);
    for (; i + kLaneCount <= count; i += kLaneCount) {
      const U32xN bits = as_bits(FloatN::load_unaligned(numbers + i));
      any_negative = any_negative | bits;
      all_negative = all_negative & bits;
    }
    const unsigned vectors_any = highest_bits(any_negative), vectors_all = highest_bits(all_negative);
    bool some = vectors_any != 0, every = vectors_all == (1u << kLaneCount) - 1;
    for (; i < count; ++i) {
      some |= std::signbit(numbers[i]);
      every &= std::signbit(numbers[i]);
    }
    return some == every;
  }

  ColumnsView<const Vec3> directions_;
  std::array<std::uint32_t, kRun> found_;
};

// The order of a run's rays: sorted by octant, otherwise stable.
class OctantOrder {
 public:
  OctantOrder(const Octants& of_run, std::span<const std::uint16_t> among) {
    for (const std::uint16_t i : among) ++first_[of_run[i] + 1];
    for (std::size_t o = 1; o <= kOctants; ++o) first_[o] += first_[o - 1];
    auto next = first_;
    for (const std::uint16_t i : among) order_[next[of_run[i]]++] = i;
  }

  static constexpr std::size_t kOctants = 8;
  std::span<const std::uint16_t> rays(std::size_t octant) const {
    return std::span(order_).subspan(first_[octant], first_[octant + 1] - first_[octant]);
  }

 private:
  std::array<std::uint16_t, kRun> order_;
  std::array<std::size_t, kOctants + 1> first_{};
};

inline constexpr std::array<std::uint16_t, kRun> kAsTheyCome = [] {
  std::array<std::uint16_t, kRun> order{};
  for (std::size_t i = 0; i < kRun; ++i) order[i] = static_cast<std::uint16_t>(i);
  return order;
}();

// Prefetches the first of the rays from `begin` on.
inline void prefetch_group(ColumnsView<const Ray> rays, std::size_t begin) {
  const std::size_t count = std::min(kGroupSize, rays.size() - begin);
  for (std::size_t c = 0; c < rays.kColumns; ++c)
    prefetch_bytes(std::as_bytes(std::span(rays.column(c) + begin, count)));
}

// Calls together(order) for groups of rays that share an octant: run[order[0]] and so on. Neighbours that
// already share an octant are taken in order, which saves reading them twice; others are sorted. Calls
// alone(i) for each ray of a group that is too small.
template <typename Together, typename Alone>
void for_each_group(ColumnsView<const Ray> run, const Together& together, const Alone& alone) {
  assert(run.size() <= kRun);
  Octants octants(run);
  std::array<std::uint16_t, kRun> mixed;
  std::size_t mixed_count = 0;
  for (std::size_t begin = 0; begin < run.size(); begin += kGroupSize) {
    const std::size_t count = std::min(kGroupSize, run.size() - begin);
    prefetch_group(run, begin + count);
    const auto group = std::span(kAsTheyCome).subspan(begin, count);
    if (count >= kMinGroup && octants.is_one(begin, count)) {
      together(group);
    } else {
      octants.find(begin, count);
      std::copy(group.begin(), group.end(), mixed.begin() + mixed_count);
      mixed_count += count;
    }
  }
  if (mixed_count == 0) return;
  const OctantOrder order(octants, std::span(mixed).first(mixed_count));
  for (std::size_t octant = 0; octant < OctantOrder::kOctants; ++octant) {
    for (auto left = order.rays(octant); !left.empty();) {
      const auto group = left.first(std::min(kGroupSize, left.size()));
      left = left.subspan(group.size());
      if (group.size() >= kMinGroup) {
        together(group);
      } else {
        for (const std::uint16_t i : group) alone(i);
      }
    }
  }
}

// Calls what(first, count) for each run of rays.
template <typename What>
void for_each_run(ColumnsView<const Ray> rays, const What& what) {
  for (std::size_t begin = 0; begin < rays.size(); begin += kRun) {
    const std::size_t count = std::min(kRun, rays.size() - begin);
    prefetch_group(rays, begin + count);
    what(begin, count);
  }
}

}  // namespace tessera::core::accel
