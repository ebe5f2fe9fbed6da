// SPDX-License-Identifier: Apache-2.0
// Sorts the rays of a batch query into groups that point into one octant (group_traversal.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/accel/ray_columns.hpp"
#include "core/base/prefetch.hpp"
#include "core/geometry/ray.hpp"

namespace tessera::core {

// Rays are sorted by octant within runs of at most this many.
inline constexpr std::size_t kRun = 512;
// Smaller groups are not worth the setup cost.
inline constexpr std::size_t kMinGroup = 8;

// The order of a run's rays: sorted by octant, otherwise stable.
class OctantOrder {
 public:
  OctantOrder(std::span<const Ray> run, std::span<const std::uint16_t> among) {
    std::array<std::uint8_t, kRun> octants;
    for (const std::uint16_t i : among)
      ++first_[(octants[i] = static_cast<std::uint8_t>(octant(run[i]))) + 1u];
    for (std::size_t o = 1; o <= kOctants; ++o) first_[o] += first_[o - 1];
    auto next = first_;
    for (const std::uint16_t i : among) order_[next[octants[i]]++] = i;
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

// Prefetches the first of the following rays.
inline void prefetch_group(std::span<const Ray> rays) {
  prefetch_bytes(std::as_bytes(rays.first(std::min(kGroupSize, rays.size()))));
}

inline bool of_one_octant(std::span<const Ray> rays) {
  const unsigned first = octant(rays.front());
  return std::all_of(rays.begin(), rays.end(), [first](const Ray& ray) { return octant(ray) == first; });
}

// Calls together(order) for groups of rays that share an octant: run[order[0]] and so on. Neighbours that
// already share an octant are taken in order, which saves reading them twice; others are sorted. Calls
// alone(i) for each ray of a group that is too small.
template <typename Together, typename Alone>
void for_each_group(std::span<const Ray> run, const Together& together, const Alone& alone) {
  assert(run.size() <= kRun);
  std::array<std::uint16_t, kRun> mixed;
  std::size_t mixed_count = 0;
  for (std::size_t begin = 0; begin < run.size(); begin += kGroupSize) {
    const std::size_t count = std::min(kGroupSize, run.size() - begin);
    prefetch_group(run.subspan(begin + count));
    const auto group = std::span(kAsTheyCome).subspan(begin, count);
    if (count >= kMinGroup && of_one_octant(run.subspan(begin, count))) {
      together(group);
    } else {
      std::copy(group.begin(), group.end(), mixed.begin() + mixed_count);
      mixed_count += count;
    }
  }
  if (mixed_count == 0) return;
  const OctantOrder order(run, std::span(mixed).first(mixed_count));
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

// Calls what(rays, answers) for each run of rays with their answers.
template <typename Answer, typename What>
void for_each_run(std::span<const Ray> rays, std::span<Answer> answers, const What& what) {
  for (std::size_t begin = 0; begin < rays.size(); begin += kRun) {
    const std::size_t count = std::min(kRun, rays.size() - begin);
    prefetch_group(rays.subspan(begin + count));
    what(rays.subspan(begin, count), answers.subspan(begin, count));
  }
}

}  // namespace tessera::core
