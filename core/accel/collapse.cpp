// SPDX-License-Identifier: Apache-2.0
#include "core/accel/collapse.hpp"

#include <limits>

#include "core/math/simd.hpp"

namespace tessera::core::accel {
namespace {

// The relative costs of testing a node's sixteen boxes and of testing a packet.
constexpr float kNodeCost = 1.5f, kPacketCost = 1;
constexpr int kTaskDepth = 10;  // deeper subtrees are not worth a task

}  // namespace

Collapse::Collapse(const BinaryBvh& tree, int threads) : tree_(tree), plans_(tree.nodes.size() / 2) {
  const double root_area = tree.nodes[0].box().half_area();
  inverse_root_area_ = root_area > 0 ? 1 / root_area : 0;
#pragma omp parallel num_threads(threads)
#pragma omp single
  plan(0, 0);
}

float Collapse::relative_area(const BinaryBvh::Node& node) const {
  return static_cast<float>(node.box().half_area() * inverse_root_area_);
}

Collapse::Costs Collapse::plan(std::uint32_t index, int depth) {
  const BinaryBvh::Node& node = tree_.nodes[index];
  if (node.is_leaf()) return Costs(kPacketCost * relative_area(node));
  Costs left, right;
  if (depth < kTaskDepth) {
#pragma omp task default(none) shared(left, node) firstprivate(depth)
    left = plan(node.left(), depth + 1);
    right = plan(node.right(), depth + 1);
#pragma omp taskwait
  } else {
    left = plan(node.left(), depth + 1);
    right = plan(node.right(), depth + 1);
  }
  return merge(node, left, right);
}

// Combines the costs of i + 1 trees below the left child and j + 1 below the right one into those of i + j
// + 2 trees, for all j at once.
Collapse::Costs Collapse::merge(const BinaryBvh::Node& node, const Costs& left, const Costs& right) {
  // Padding before the costs of the right child, so that they can be loaded at an offset.
  float shifted[2 * kWidth];
  for (std::size_t i = 0; i < kWidth; i += kLaneCount) {
    FloatN::broadcast(std::numeric_limits<float>::infinity()).store_unaligned(shifted + i);
    FloatN::load(right.of_trees + i).store_unaligned(shifted + kWidth + i);
  }
  Costs costs;
  alignas(32) float left_trees[kWidth];
  for (std::size_t half = 0; half < kWidth; half += kLaneCount) {
    FloatN best = FloatN::broadcast(std::numeric_limits<float>::infinity()), choice = FloatN::broadcast(0);
    for (std::size_t i = 0; i + 1 < half + kLaneCount; ++i) {
      const FloatN cost =
          FloatN::broadcast(left.of_trees[i]) + FloatN::load_unaligned(shifted + kWidth + half - (i + 1));
      choice = select(cost < best, FloatN::broadcast(static_cast<float>(i + 1)), choice);
      best = min(cost, best);
    }
    best.store(costs.of_trees + half);
    choice.store(left_trees + half);
  }
  // A single tree is a wide node whose children are the cheapest forest of up to sixteen trees.
  const float whole = kNodeCost * relative_area(node) + costs.of_trees[kWidth - 1];
  Plan& plan = plan_of(node);
  for (std::size_t i = 0; i < kWidth; ++i) {
    const bool keep = i == 0 || whole < costs.of_trees[i];
    costs.of_trees[i] = keep ? whole : costs.of_trees[i];
    plan[i] = keep ? 0 : static_cast<std::uint8_t>(left_trees[i]);
  }
  return costs;
}

Forest Collapse::children(std::uint32_t root) const {
  Forest forest;
  add_forest(root, BvhNode::kWidth, forest);
  return forest;
}

void Collapse::add_forest(std::uint32_t node, int trees, Forest& forest) const {
  const BinaryBvh::Node& binary = tree_.nodes[node];
  const int left_trees = binary.is_leaf() ? 0 : plan_of(binary)[static_cast<std::size_t>(trees - 1)];
  if (left_trees == 0) return forest.add(node);
  add_forest(binary.left(), left_trees, forest);
  add_forest(binary.right(), trees - left_trees, forest);
}

}  // namespace tessera::core::accel
