// Which nodes of a binary tree become the nodes of a wide one: those that make the expected cost of a ray,
// by the surface area heuristic, the least of all ways to merge them (Ylitie, Karras and Laine 2017,
// section 3.1).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/accel/binary_bvh.hpp"
#include "core/accel/bvh_layout.hpp"

namespace tessera::core {

class Collapse {
 public:
  // Keeps a reference to `tree`, which has nodes.
  explicit Collapse(const BinaryBvh& tree);

  // Up to sixteen descendants of `root` that together hold all of it; itself where it is a leaf.
  std::vector<std::uint32_t> children(std::uint32_t root) const;

 private:
  // A binary node seen as a forest of at most i + 1 wide nodes and leaves, for each i.
  struct Plan {
    std::array<double, BvhNode::kWidth> cost;
    // How many trees of the forest stand below the left child, all others below the right; 0 where the node
    // is kept whole.
    std::array<std::uint8_t, BvhNode::kWidth> left_trees;
  };

  Plan plan(std::uint32_t node) const;
  void add_forest(std::uint32_t node, int trees, std::vector<std::uint32_t>& roots) const;

  const BinaryBvh& tree_;
  std::vector<Plan> plans_;  // one for each binary node
};

}  // namespace tessera::core
