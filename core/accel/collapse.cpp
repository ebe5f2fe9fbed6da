#include "core/accel/collapse.hpp"

#include <limits>

namespace tessera::core {
namespace {

// What it costs to test a node's sixteen boxes, and to test a packet.
constexpr double kNodeCost = 1.5, kPacketCost = 1;

}  // namespace

Collapse::Collapse(const BinaryBvh& tree) : tree_(tree), plans_(tree.nodes.size()) {
  // Children stand behind their parents. Gaps between nodes look like leaves, and nobody asks for them.
  for (std::size_t node = plans_.size(); node-- > 0;) plans_[node] = plan(static_cast<std::uint32_t>(node));
}

Collapse::Plan Collapse::plan(std::uint32_t node) const {
  const BinaryBvh::Node& binary = tree_.nodes[node];
  const double area = binary.box.half_area();
  Plan plan;
  plan.left_trees.fill(0);
  plan.cost.fill(kPacketCost * area);
  if (binary.is_leaf()) return plan;

  const Plan& left = plans_[node + 1];
  const Plan& right = plans_[binary.right];
  plan.cost.fill(std::numeric_limits<double>::infinity());
  for (std::size_t trees = 2; trees <= BvhNode::kWidth; ++trees) {
    for (std::size_t below_left = 1; below_left < trees; ++below_left) {
      const double cost = left.cost[below_left - 1] + right.cost[trees - below_left - 1];
      if (!(cost < plan.cost[trees - 1])) continue;
      plan.cost[trees - 1] = cost;
      plan.left_trees[trees - 1] = static_cast<std::uint8_t>(below_left);
    }
  }
  // A single tree is a wide node, whose children are the cheapest forest of sixteen.
  plan.cost[0] = kNodeCost * area + plan.cost[BvhNode::kWidth - 1];
  for (std::size_t i = 1; i < BvhNode::kWidth; ++i) {
    if (plan.cost[0] < plan.cost[i]) plan.cost[i] = plan.cost[0], plan.left_trees[i] = 0;
  }
  plan.left_trees[0] = 0;
  return plan;
}

std::vector<std::uint32_t> Collapse::children(std::uint32_t root) const {
  std::vector<std::uint32_t> roots;
  add_forest(root, BvhNode::kWidth, roots);
  return roots;
}

void Collapse::add_forest(std::uint32_t node, int trees, std::vector<std::uint32_t>& roots) const {
  const int left_trees = plans_[node].left_trees[static_cast<std::size_t>(trees - 1)];
  if (left_trees == 0) {
    roots.push_back(node);
  } else {
    add_forest(node + 1, left_trees, roots);
    add_forest(tree_.nodes[node].right, trees - left_trees, roots);
  }
}

}  // namespace tessera::core
