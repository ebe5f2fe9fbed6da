// SPDX-License-Identifier: Apache-2.0
// Decides which binary nodes become nodes of the wide tree, by minimising the expected cost of a ray under
// the surface area heuristic over all ways to merge them (Ylitie, Karras and Laine 2017, section 3.1).
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/accel/binary_bvh.hpp"
#include "core/accel/bvh_layout.hpp"
#include "core/accel/huge_pages.hpp"

namespace tessera::core::accel {

// A set of up to sixteen binary nodes.
class Forest {
 public:
  void add(std::uint32_t node) { roots_[size_++] = node; }
  std::size_t size() const { return size_; }
  const std::uint32_t* begin() const { return roots_.data(); }
  const std::uint32_t* end() const { return roots_.data() + size_; }

 private:
  std::array<std::uint32_t, BvhNode::kWidth> roots_;
  std::size_t size_ = 0;
};

class Collapse {
 public:
  // Keeps a reference to `tree`, which must have nodes.
  Collapse(const BinaryBvh& tree, int threads);

  // Up to sixteen descendants of `root` that together cover its subtree; `root` itself if it is a leaf.
  Forest children(std::uint32_t root) const;

 private:
  static constexpr std::size_t kWidth = BvhNode::kWidth;

  // The cost of a binary node's subtree as a forest of at most i + 1 wide nodes and leaves, for each i.
  struct Costs {
    alignas(32) float of_trees[kWidth];

    Costs() = default;
    explicit Costs(float of_any) { std::fill_n(of_trees, kWidth, of_any); }
  };
  // For each such forest, the number of its trees below the left child; the rest are below the right one. 0
  // if the node is kept whole.
  using Plan = std::array<std::uint8_t, kWidth>;

  Costs plan(std::uint32_t index, int depth);
  Costs merge(const BinaryBvh::Node& node, const Costs& left, const Costs& right);
  Plan& plan_of(const BinaryBvh::Node& parent) { return plans_[parent.left() / 2]; }
  const Plan& plan_of(const BinaryBvh::Node& parent) const { return plans_[parent.left() / 2]; }
  float relative_area(const BinaryBvh::Node& node) const;
  void add_forest(std::uint32_t node, int trees, Forest& forest) const;

  const BinaryBvh& tree_;
  double inverse_root_area_;
  HugePageArray<Plan> plans_;  // one for each pair of children
};

}  // namespace tessera::core::accel
