// Bvh::build: a binary tree is built, its nodes are merged sixteen at a time, and leaves become packets.
#include <algorithm>

#include "core/accel/binary_bvh.hpp"
#include "core/accel/bvh.hpp"
#include "core/accel/collapse.hpp"

namespace tessera::core {
namespace {

class WideBuilder {
 public:
  WideBuilder(const Primitives& primitives, const BinaryBvh& tree)
      : primitives_(primitives), tree_(tree), collapse_(tree) {}

  // Appends the wide node that stands for binary node `root`, and all below. The depth of the recursion is
  // that of the binary tree at most.
  std::uint32_t add_node(std::uint32_t root) {
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    int lane = 0;
    for (const std::uint32_t child : collapse_.children(root)) {
      const BinaryBvh::Node& node = tree_.nodes[child];
      const BvhChild reference =
          node.is_leaf() ? BvhChild::packet(add_packet(node)) : BvhChild::node(add_node(child));
      set_lane(nodes_[index], lane++, node.box, reference);
    }
    return index;
  }

  HugePageVector<BvhNode> take_nodes() { return std::move(nodes_); }
  HugePageVector<BvhPacket> take_packets() { return std::move(packets_); }

 private:
  std::uint32_t add_packet(const BinaryBvh::Node& leaf) {
    BvhPacket packet;
    for (std::uint32_t lane = 0; lane < leaf.count(); ++lane) {
      const std::uint32_t primitive = tree_.order[leaf.begin + lane];
      packet.primitives[lane] = primitive;
      if (primitives_.is_sphere(primitive)) {
        packet.sphere_lanes |= 1u << lane;
      } else {
        packet.triangle_lanes |= 1u << lane;
        set_corners(packet, lane, primitives_.triangle_corners(primitive));
      }
    }
    packets_.push_back(packet);
    return static_cast<std::uint32_t>(packets_.size() - 1);
  }

  static void set_corners(BvhPacket& packet, std::uint32_t lane, const TriangleCorners& corners) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      for (int axis = 0; axis < 3; ++axis) packet.corners[corner][axis][lane] = corners[corner][axis];
    }
  }

  static void set_lane(BvhNode& node, int lane, const Aabb& box, BvhChild child) {
    for (int axis = 0; axis < 3; ++axis) {
      node.bounds[3 * BvhNode::kLower + axis][lane] = box.lower[axis];
      node.bounds[3 * BvhNode::kUpper + axis][lane] = box.upper[axis];
    }
    node.children[static_cast<std::size_t>(lane)] = child;
  }

  const Primitives& primitives_;
  const BinaryBvh& tree_;
  const Collapse collapse_;
  HugePageVector<BvhNode> nodes_;
  HugePageVector<BvhPacket> packets_;
};

}  // namespace

BvhNode::BvhNode() {
  children.fill(BvhChild::packet(0));
  const Aabb empty;
  for (int axis = 0; axis < 3; ++axis) {
    std::fill_n(bounds[3 * kLower + axis], kWidth, empty.lower[axis]);
    std::fill_n(bounds[3 * kUpper + axis], kWidth, empty.upper[axis]);
  }
}

Bvh::Bvh(HugePageVector<BvhNode> nodes, HugePageVector<BvhPacket> packets)
    : nodes_(std::move(nodes)), packets_(std::move(packets)) {}

Bvh Bvh::build(const Primitives& primitives, int threads) {
  const BinaryBvh tree = build_binary_bvh(primitives, threads);
  if (tree.nodes.empty()) return {};
  WideBuilder builder(primitives, tree);
  builder.add_node(0);
  return Bvh(builder.take_nodes(), builder.take_packets());
}

}  // namespace tessera::core
