// SPDX-License-Identifier: Apache-2.0
// Chooses a split of a set of boxes by the surface area heuristic: centroids are sorted into bins along
// each axis, and the borders between bins are compared (Wald 2007).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "core/accel/build_box.hpp"

namespace tessera::core::accel {

inline constexpr int kBins = 16;

// Maps items to bins. The bins divide the bounds of all half centroids evenly along each axis.
class Binning {
 public:
  explicit Binning(const Aabb& half_centroids);

  // The bins of two items: of `a` in the first three lanes of the lower half, of `b` in those of the upper
  // half.
  U32xN bins(BuildBox a, BuildBox b) const {
    const FloatN half_centroids = upper_halves(a.half_centroid().v, b.half_centroid().v);
    return min(truncated((half_centroids - origin_) * bins_per_length_), U32xN(kBins - 1));
  }

 private:
  FloatN origin_, bins_per_length_;  // equal in both halves
};

struct Split {
  float cost = std::numeric_limits<float>::infinity();
  int axis = -1;  // -1 if all centroids are the same
  int first_right_bin = 0;
  BuildBox left, right;  // bounds of the items on either side
};

// The bounds and number of items in each bin.
class Bins {
 public:
  void add(const Binning& binning, std::span<const BuildItem> items);
  void add(const Bins& other);

  // The cheapest border between two bins; `bounds` encloses all items.
  Split best_split(const Aabb& bounds) const;

 private:
  // The bins with the same index along each axis.
  struct Row {
    std::array<BuildBox, 3> boxes;
    alignas(32) std::array<std::uint32_t, 4> counts{};
  };

  // `bins` holds the item's bin along each axis.
  void add(BuildBox box, const std::uint32_t* bins) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Row& row = rows_[bins[axis]];
      row.boxes[axis].include(box);
      ++row.counts[axis];
    }
  }

  std::array<Row, kBins> rows_;
};

}  // namespace tessera::core::accel
