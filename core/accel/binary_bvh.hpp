// The binary tree from which a Bvh is made: top-down, by the surface area heuristic over binned centroids
// (Wald 2007). Its shape does not depend on the number of threads, and its depth is bounded.
#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry/aabb.hpp"
#include "core/geometry/primitives.hpp"

namespace tessera::core {

struct BinaryBvh {
  struct Node {
    Aabb box;
    std::uint32_t begin = 0, end = 0;  // of `order`: the primitives below
    std::uint32_t right = 0;  // index of the right child, the left one follows its parent; 0 for a leaf

    bool is_leaf() const { return right == 0; }
    std::uint32_t count() const { return end - begin; }
  };

  std::vector<Node> nodes;           // the root first, with gaps; empty if nothing can be hit
  std::vector<std::uint32_t> order;  // primitive ids
};

inline constexpr std::uint32_t kMaxLeafSize = 4;

// The surface area heuristic decides down to this depth; below, ranges are halved.
inline constexpr int kMaxSahDepth = 40;
inline constexpr int kMaxBinaryDepth = kMaxSahDepth + 32;

// Leaves out what cannot be hit (Primitives::bounds is empty).
BinaryBvh build_binary_bvh(const Primitives& primitives, int threads);

}  // namespace tessera::core
