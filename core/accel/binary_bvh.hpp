// SPDX-License-Identifier: Apache-2.0
// The binary tree from which a Bvh is made: top-down, by the surface area heuristic over binned centroids
// (Wald 2007), by all threads from the first cut on. Its shape does not depend on the number of threads, and
// its depth is bounded.
#pragma once

#include <cstdint>

#include "core/accel/huge_pages.hpp"
#include "core/geometry/aabb.hpp"
#include "core/geometry/primitives.hpp"

namespace tessera::core {

struct BinaryBvh {
  struct Node {
    Vec3 lower;
    std::uint32_t first;  // the left child, which the right one follows; of a leaf: its place in `order`
    Vec3 upper;
    std::uint32_t count;  // of a leaf's primitives; 0 for all other nodes

    bool is_leaf() const { return count != 0; }
    std::uint32_t left() const { return first; }
    std::uint32_t right() const { return first + 1; }
    Aabb box() const { return {lower, upper}; }
  };

  // The root first; then children in pairs, with gaps between them and in an order that the threads have
  // settled among themselves. Empty if nothing can be hit.
  HugePageArray<Node> nodes;
  HugePageArray<std::uint32_t> order;  // primitive ids, leaf by leaf
};

inline constexpr std::uint32_t kMaxLeafSize = 4;

// The surface area heuristic decides down to this depth; below, ranges are halved.
inline constexpr int kMaxSahDepth = 40;
inline constexpr int kMaxBinaryDepth = kMaxSahDepth + 32;

// Leaves out what cannot be hit (Primitives::bounds is empty).
BinaryBvh build_binary_bvh(const Primitives& primitives, int threads);

}  // namespace tessera::core
