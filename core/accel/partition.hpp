// SPDX-License-Identifier: Apache-2.0
// Parts a range of items by one border between bins, in place, and finds the bounds of both parts' centroids
// on the way.
#pragma once

#include <algorithm>
#include <span>

#include "core/accel/binning.hpp"

namespace tessera::core {

struct Parts {
  std::size_t left_count = 0;
  BuildBox left_half_centroids, right_half_centroids;
};

// Items before the split's border come to stand before the others. The order in which they stand depends on
// nothing but the order before.
Parts partition(std::span<BuildItem> items, const Binning& binning, const Split& split);

// As above, with the help of the other threads of the parallel region within which it is called. The order
// may be another, but does not depend on the number of threads either.
Parts partition_in_parallel(std::span<BuildItem> items, const Binning& binning, const Split& split);

// The items' bounds.
RangeBounds bounds_of(std::span<const BuildItem> items);

// Ranges of at least this size are worth many threads; they are worked on in pieces of this size.
inline constexpr std::size_t kParallelSize = 1u << 16;
inline constexpr std::size_t kPiece = 1u << 14;
inline std::size_t piece_count(std::size_t size) {
  return (size + kPiece - 1) / kPiece;
}
inline std::span<BuildItem> piece_of(std::span<BuildItem> items, std::size_t piece) {
  return items.subspan(piece * kPiece, std::min(kPiece, items.size() - piece * kPiece));
}

}  // namespace tessera::core
