// Where to cut a set of boxes in two by the surface area heuristic: their centroids are sorted into bins
// along each axis, and the borders between bins are compared (Wald 2007).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>

#include "core/accel/build_box.hpp"

namespace tessera::core {

inline constexpr int kBins = 16;

// Which bin an item falls into: of as many of equal length as there are along each axis of the centroids'
// bounds.
class Binning {
 public:
  explicit Binning(const BuildBox& centroids);

  // In the first three lanes, from 0 to kBins - 1.
  Int4 bins(BuildBox box) const {
    const Float4 position = (box.half_centroid() - origin_) * bins_per_length_;
    return clamp(Int4::truncated(position), Int4::broadcast(0), Int4::broadcast(kBins - 1));
  }

 private:
  Float4 origin_, bins_per_length_;
};

struct Split {
  float cost = std::numeric_limits<float>::infinity();
  int axis = -1;  // none where all centroids are the same
  int first_right_bin = 0;
};

// What fell into each bin.
class Bins {
 public:
  void add(const Binning& binning, std::span<const BuildItem> items);
  void add(const Bins& other);

  // The cheapest border between two bins; `bounds` is that of all items.
  Split best_split(const BuildBox& bounds) const;

 private:
  std::array<std::array<BuildBox, kBins>, 3> boxes_;
  std::array<std::array<std::uint32_t, kBins>, 3> counts_{};
};

}  // namespace tessera::core
