// SPDX-License-Identifier: Apache-2.0
// The binary tree from which a Bvh is made: top-down, by the surface area heuristic over binned centroids
// (Wald 2007), parallel from the first split on. Its shape does not depend on the number of threads, and
// its depth is bounded.
#pragma once

#include <cstdint>

#include "core/accel/bvh_layout.hpp"
#include "core/accel/huge_pages.hpp"
#include "core/geometry/aabb.hpp"
#include "core/geometry/primitives.hpp"

namespace tessera::core::accel {

struct BinaryBvh {
  struct Node {
    Vec3 lower;
    std::uint32_t first;  // index of the left child, the right one follows; of a leaf, into `order`
    Vec3 upper;
    std::uint32_t count;  // number of primitives of a leaf; 0 for inner nodes

    bool is_leaf() const { return count != 0; }
    std::uint32_t left() const { return first; }
    std::uint32_t right() const { return first + 1; }
    Aabb box() const { return {lower, upper}; }
  };

  // The root comes first. Children are stored in pairs, with gaps between them, in an order that depends on
  // thread timing. Empty if nothing can be hit.
  HugePageArray<Node> nodes;
  HugePageArray<std::uint32_t> order;  // primitive ids, leaf by leaf
};

inline constexpr std::uint32_t kMaxLeafSize = 4;

// The surface area heuristic applies down to this depth; below, ranges are halved.
inline constexpr int kMaxSahDepth = kMaxTreeDepth - 32;

// Leaves out primitives that cannot be hit (those whose Primitives::bounds are empty).
BinaryBvh build_binary_bvh(const Primitives& primitives, int threads);

}  // namespace tessera::core::accel
