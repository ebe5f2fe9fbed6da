// SPDX-License-Identifier: Apache-2.0
// Partitions a range of items in place at a border between bins, and computes the bounds of both parts'
// centroids.
#pragma once

#include <algorithm>
#include <span>

#include "core/accel/binning.hpp"

namespace tessera::core::accel {

struct Parts {
  std::size_t left_count = 0;
  BuildBox left_half_centroids, right_half_centroids;
};

// Moves the items before the split's border to the front. The resulting order depends only on the input
// order.
Parts partition(std::span<BuildItem> items, const Binning& binning, const Split& split);

// As above, using the other threads of the enclosing parallel region. The order may differ from that of
// partition(), but does not depend on the number of threads either.
Parts partition_in_parallel(std::span<BuildItem> items, const Binning& binning, const Split& split);

// The bounds of the items.
RangeBounds bounds_of(std::span<const BuildItem> items);

// Ranges of at least this size are processed in parallel, in pieces of this size.
inline constexpr std::size_t kParallelSize = 1u << 16;
inline constexpr std::size_t kPiece = 1u << 14;
inline std::size_t piece_count(std::size_t size) {
  return (size + kPiece - 1) / kPiece;
}
inline std::span<BuildItem> piece_of(std::span<BuildItem> items, std::size_t piece) {
  return items.subspan(piece * kPiece, std::min(kPiece, items.size() - piece * kPiece));
}

}  // namespace tessera::core::accel
