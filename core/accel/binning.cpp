// SPDX-License-Identifier: Apache-2.0
#include "core/accel/binning.hpp"

#include <algorithm>

#include "core/accel/binary_bvh.hpp"

namespace tessera::core::accel {
namespace {

// A factor that scales the longest side of `bounds` to a quarter, so that areas neither overflow nor
// vanish.
float scale_of(const Aabb& bounds) {
  const double longest = std::max({bounds.extent(0), bounds.extent(1), bounds.extent(2)});
  return static_cast<float>(std::min(0.25 / longest, double{std::numeric_limits<float>::max()}));
}

// Half areas of the scaled boxes: of a[i] in lane i of the lower half, of b[i] in lane i of the upper half.
FloatN half_areas(const std::array<BuildBox, 3>& a, const std::array<BuildBox, 3>& b, FloatN scale) {
  const auto extents = [&](std::size_t i) {
    return lower_halves(a[i].v, b[i].v) * scale + upper_halves(a[i].v, b[i].v) * scale;
  };
  const auto [x, y, z] = transposed_halves(extents(0), extents(1), extents(2));
  return x * y + y * z + z * x;
}

// The number of packets that these many primitives take.
FloatN packets(U32xN counts) {
  static_assert(kMaxLeafSize == 4);
  return to_float((counts + U32xN(kMaxLeafSize - 1)) >> 2);
}

float bins_per_length(double extent) {
  constexpr double kBelowTheLast = 1 - 1e-6;
  const double bins = kBins * kBelowTheLast / extent;
  return bins < std::numeric_limits<float>::max() ? static_cast<float>(bins) : 0;
}

}  // namespace

Binning::Binning(const Aabb& half_centroids) {
  const Aabb& box = half_centroids;
  origin_ = in_both_halves(box.lower.x, box.lower.y, box.lower.z, 0);
  bins_per_length_ = in_both_halves(bins_per_length(box.extent(0)), bins_per_length(box.extent(1)),
                                    bins_per_length(box.extent(2)), 0);
}

// Adds items alternately from the two halves of the range. Neighbouring items often fall into the same bin,
// where the second addition would wait for the first.
void Bins::add(const Binning& binning, std::span<const BuildItem> items) {
  alignas(32) std::uint32_t bins[8];
  const std::size_t half = items.size() / 2;
  for (std::size_t i = 0; i < half; ++i) {
    const BuildBox a = items[i].box(), b = items[half + i].box();
    binning.bins(a, b).store(bins);
    add(a, bins);
    add(b, bins + 4);
  }
  if (items.size() % 2 != 0) {
    const BuildBox last = items.back().box();
    binning.bins(last, last).store(bins);
    add(last, bins);
  }
}

void Bins::add(const Bins& other) {
  for (std::size_t bin = 0; bin < kBins; ++bin)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      rows_[bin].boxes[axis].include(other.rows_[bin].boxes[axis]);
      rows_[bin].counts[axis] += other.rows_[bin].counts[axis];
    }
}

// The cost of a part is the probability that a ray meets it times its number of packets. It is NaN for an
// empty part, so that such a split is never chosen.
Split Bins::best_split(const Aabb& bounds) const {
  // Sweeps from both ends at once, with one axis in each lane. The lower half of costs[i] holds the cost of
  // the part before border i, the upper half that of the part behind border kBins - i.
  std::array<FloatN, kBins> costs;
  std::array<BuildBox, 3> first, last;
  U32xN counts(0);
  const FloatN scale(scale_of(bounds));
  for (std::size_t i = 1; i < kBins; ++i) {
    const Row &next_first = rows_[i - 1], &next_last = rows_[kBins - i];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      first[axis].include(next_first.boxes[axis]);
      last[axis].include(next_last.boxes[axis]);
    }
    counts = counts + load_halves(next_first.counts.data(), next_last.counts.data());
    costs[i] = half_areas(first, last, scale) * packets(counts);
  }
  // The lower half belongs to border i, the upper half to border kBins - i.
  FloatN least(std::numeric_limits<float>::infinity());
  U32xN least_at(0);
  for (std::size_t i = 1; i <= kBins / 2; ++i) {
    const FloatN cost = costs[i] + with_halves_swapped(costs[kBins - i]);
    least_at = select(cost < least, U32xN(static_cast<std::uint32_t>(i)), least_at);
    least = min(cost, least);
  }

  alignas(32) float cost[8];
  alignas(32) std::uint32_t at[8];
  least.store(cost);
  least_at.store(at);
  Split best;
  for (int axis = 0; axis < 3; ++axis) {
    const auto border = static_cast<int>(at[axis]), border_from_end = kBins - static_cast<int>(at[axis + 4]);
    if (cost[axis] < best.cost) best = {cost[axis], axis, border, {}, {}};
    if (cost[axis + 4] < best.cost) best = {cost[axis + 4], axis, border_from_end, {}, {}};
  }
  if (best.axis < 0) return best;
  const auto axis = static_cast<std::size_t>(best.axis);
  const auto border = rows_.begin() + best.first_right_bin;
  for (auto row = rows_.begin(); row != border; ++row) best.left.include(row->boxes[axis]);
  for (auto row = border; row != rows_.end(); ++row) best.right.include(row->boxes[axis]);
  return best;
}

}  // namespace tessera::core::accel
