// SPDX-License-Identifier: Apache-2.0
// Bvh::build: builds a binary tree, collapses it into sixteen-wide nodes, and turns leaves into packets.
#include <algorithm>
#include <utility>
#include <vector>

#include "core/accel/binary_bvh.hpp"
#include "core/accel/bvh.hpp"
#include "core/accel/collapse.hpp"
#include "core/accel/tube_test.hpp"

namespace tessera::core::accel {
namespace {

// The numbers of nodes and packets of a part of the wide tree.
struct Extent {
  std::uint32_t nodes = 0, packets = 0;
};

// Converts binary nodes to wide nodes. The top of the tree is laid out first, breadth first. The subtrees
// below it follow, each depth first and in parallel; counting all subtrees first gives each its offset.
class WideBuilder {
 public:
  WideBuilder(const Primitives& primitives, const BinaryBvh& tree, int threads)
      : primitives_(primitives), tree_(tree), threads_(threads), collapse_(tree, threads) {
    lay_out_top();
    count_subtrees();
    nodes_ = HugePageArray<BvhNode>(end_.nodes);
    packets_ = HugePageArray<BvhPacket>(end_.packets);
    fill();
  }

  HugePageArray<BvhNode> take_nodes() { return std::move(nodes_); }
  HugePageArray<BvhPacket> take_packets() { return std::move(packets_); }

 private:
  static constexpr std::size_t kSubtrees = 1024;

  // A binary node that becomes a wide node, and the offsets of its subtree.
  struct Root {
    std::uint32_t node;
    Extent begin;
  };

  // Opens nodes until there are enough subtrees for all threads.
  void lay_out_top() {
    std::vector<std::uint32_t> level{0};
    while (!level.empty() && level.size() < kSubtrees) {
      std::vector<std::uint32_t> next;
      for (const std::uint32_t root : level) {
        top_.push_back({root, {}});
        for (const std::uint32_t child : collapse_.children(root))
          if (!tree_.nodes[child].is_leaf()) next.push_back(child);
      }
      level = std::move(next);
    }
    for (const std::uint32_t root : level) subtrees_.push_back({root, {}});
  }

  void count_subtrees() {
    std::vector<Extent> extents(subtrees_.size());
#pragma omp parallel for num_threads(threads_) schedule(dynamic)
    for (std::size_t i = 0; i < subtrees_.size(); ++i) add_extent(subtrees_[i].node, extents[i]);
    end_.nodes = static_cast<std::uint32_t>(top_.size());
    for (Root& root : top_) {
      root.begin.packets = end_.packets;
      for (const std::uint32_t child : collapse_.children(root.node))
        end_.packets += tree_.nodes[child].is_leaf();
    }
    for (std::size_t i = 0; i < subtrees_.size(); ++i) {
      subtrees_[i].begin = end_;
      end_.nodes += extents[i].nodes;
      end_.packets += extents[i].packets;
    }
  }

  void add_extent(std::uint32_t root, Extent& extent) const {
    ++extent.nodes;
    for (const std::uint32_t child : collapse_.children(root)) {
      if (tree_.nodes[child].is_leaf()) {
        ++extent.packets;
      } else {
        add_extent(child, extent);
      }
    }
  }

  void fill() {
    // Nodes of the top are stored in the order in which they were opened, level by level; the subtrees
    // follow.
    std::size_t opened = 1;
    for (std::uint32_t i = 0; i < top_.size(); ++i) {
      Extent at = top_[i].begin;
      fill_node(top_[i].node, i, at, [&](std::uint32_t) {
        const std::size_t next = opened++;
        return next < top_.size() ? static_cast<std::uint32_t>(next)
                                  : subtrees_[next - top_.size()].begin.nodes;
      });
    }
#pragma omp parallel for num_threads(threads_) schedule(dynamic)
    for (std::size_t i = 0; i < subtrees_.size(); ++i) {
      Extent at = subtrees_[i].begin;
      fill_subtree(subtrees_[i].node, at);
    }
  }

  // Writes the wide node for binary node `root` and its subtree, starting at `at`, and advances `at` past
  // them. The recursion is at most as deep as the binary tree.
  std::uint32_t fill_subtree(std::uint32_t root, Extent& at) {
    const std::uint32_t index = at.nodes++;
    fill_node(root, index, at, [&](std::uint32_t child) { return fill_subtree(child, at); });
    return index;
  }

  // `index_of` returns the index of the wide node that an inner child becomes.
  template <typename IndexOf>
  void fill_node(std::uint32_t root, std::uint32_t index, Extent& at, const IndexOf& index_of) {
    BvhNode wide;
    int lane = 0;
    for (const std::uint32_t child : collapse_.children(root)) {
      const BinaryBvh::Node& node = tree_.nodes[child];
      if (node.is_leaf()) packets_[at.packets] = make_packet(node);
      set_lane(wide, lane++, node.box(),
               node.is_leaf() ? BvhChild::packet(at.packets++) : BvhChild::node(index_of(child)));
    }
    nodes_[index] = wide;
  }

  BvhPacket make_packet(const BinaryBvh::Node& leaf) const {
    BvhPacket packet;
    packet.kind = primitives_.kind(tree_.order[leaf.first]);
    packet.lanes = (1u << leaf.count) - 1;
    for (std::uint32_t lane = 0; lane < leaf.count; ++lane) {
      const std::uint32_t primitive = tree_.order[leaf.first + lane];
      packet.primitives[lane] = primitive;
      if (packet.kind == GeometryKind::kTriangle) {
        set_corners(packet, lane, primitives_.triangle_corners(primitive));
      } else if (packet.kind == GeometryKind::kCurve) {
        set_tube(packet, lane, tube_around(primitives_.curve(primitive)));
        set_source(packet, lane, primitives_.curve_source(primitive));
      }
    }
    return packet;
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
  const int threads_;
  const Collapse collapse_;
  std::vector<Root> top_, subtrees_;
  Extent end_;
  HugePageArray<BvhNode> nodes_;
  HugePageArray<BvhPacket> packets_;
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

Bvh Bvh::build(const Primitives& primitives, int threads) {
  Bvh bvh;
  for (const Primitives& object : primitives.objects())
    bvh.arrays_.objects.push_back(build(object, threads).arrays_);
  bvh.rebuild_own(primitives, threads);
  return bvh;
}

void Bvh::rebuild(const Primitives& primitives, int threads) {
  for (std::size_t i = 0; i < primitives.objects().size(); ++i)
    if (primitives.objects()[i].can_deform())
      arrays_.objects[i] = build(primitives.objects()[i], threads).arrays_;
  rebuild_own(primitives, threads);
}

void Bvh::rebuild_own(const Primitives& primitives, int threads) {
  arrays_.nodes = {};
  arrays_.packets = {};
  const BinaryBvh tree = build_binary_bvh(primitives, threads);
  if (tree.nodes.empty()) return;
  WideBuilder builder(primitives, tree, threads);
  arrays_.nodes = builder.take_nodes();
  arrays_.packets = builder.take_packets();
}

std::size_t Bvh::memory_bytes() const {
  const auto bytes = [](const auto& self, const Arrays& arrays) -> std::size_t {
    std::size_t sum = arrays.nodes.size() * sizeof(BvhNode) + arrays.packets.size() * sizeof(BvhPacket);
    for (const Arrays& object : arrays.objects) sum += self(self, object);
    return sum;
  };
  return bytes(bytes, arrays_);
}

}  // namespace tessera::core::accel
