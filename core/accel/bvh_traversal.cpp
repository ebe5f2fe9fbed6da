// Bvh's queries: nodes are visited nearest first, from a stack, and culled where they cannot hold a better
// hit.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "core/accel/binary_bvh.hpp"
#include "core/accel/bvh.hpp"
#include "core/accel/simd.hpp"
#include "core/geometry/rounding.hpp"

namespace tessera::core {
namespace {

enum class Query { kClosest, kAny };

// Distances to slabs are computed with three roundings (Ize 2013), and the distance of a hit, otherwise exact
// to nearly double precision, is rounded once: with this factor on the near side no box is missed that holds
// a hit.
constexpr float kSlack = 1 - 2 * gamma<float>(4);

// A ray prepared for box tests.
struct SlabRay {
  explicit SlabRay(const Ray& ray) {
    for (int axis = 0; axis < 3; ++axis) {
      const float inverse = 1 / ray.direction[axis];
      origin[axis] = Float8::broadcast(ray.origin[axis]);
      inverse_direction[axis] = Float8::broadcast(inverse);
      near_side[axis] = std::signbit(inverse) ? BvhNode::kUpper : BvhNode::kLower;
    }
  }

  Float8 distance(const BvhNode& node, int side, int axis) const {
    return (Float8::load(node.bounds[side][axis]) - origin[axis]) * inverse_direction[axis];
  }

  Float8 origin[3], inverse_direction[3];
  int near_side[3];
};

struct StackEntry {
  float t_near;
  BvhChild child;
};

// What is yet to be visited, nearest on top. Each level of the tree leaves at most seven siblings behind.
class Stack {
 public:
  bool empty() const { return size_ == 0; }
  StackEntry pop() { return entries_[--size_]; }
  void push(BvhChild child) { entries_[size_++] = {0, child}; }

  // Pushes the lanes of `node` that are in `mask`, the nearest last.
  void push_sorted(const BvhNode& node, unsigned mask, const float* t_near) {
    const std::size_t base = size_;
    for (; mask != 0; mask &= mask - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(mask));
      std::size_t slot = size_++;
      for (; slot > base && entries_[slot - 1].t_near < t_near[lane]; --slot)
        entries_[slot] = entries_[slot - 1];
      entries_[slot] = {t_near[lane], node.children[lane]};
    }
  }

 private:
  static constexpr std::size_t kSize = 1 + (BvhNode::kWidth - 1) * (kMaxBinaryDepth + 1);
  std::array<StackEntry, kSize> entries_;
  std::size_t size_ = 0;
};

// The lanes whose edge functions do not rule out a hit: the first half of intersect_triangle, four at a time.
// These edge functions may be 0 where the exact ones are not, but never have the wrong sign.
unsigned possible_hits(const BvhPacket& packet, const ShearedRay& ray) {
  Double4 x[3], y[3];
  for (int i = 0; i < 3; ++i) {
    const Double4 z = Double4::load(packet.corners[i][ray.z_axis]) - Double4::broadcast(ray.origin_z);
    x[i] = Double4::load(packet.corners[i][ray.x_axis]) - Double4::broadcast(ray.origin_x);
    y[i] = Double4::load(packet.corners[i][ray.y_axis]) - Double4::broadcast(ray.origin_y);
    x[i] = x[i] - Double4::broadcast(ray.shear_x) * z;
    y[i] = y[i] - Double4::broadcast(ray.shear_y) * z;
  }
  const Double4 e0 = x[1] * y[2] - y[1] * x[2];
  const Double4 e1 = x[2] * y[0] - y[2] * x[0];
  const Double4 e2 = x[0] * y[1] - y[0] * x[1];
  const Double4 zero = Double4::broadcast(0);
  const unsigned any_negative = less(min(min(e0, e1), e2), zero);
  const unsigned any_positive = less(zero, max(max(e0, e1), e2));
  return packet.triangle_lanes & ~(any_negative & any_positive);
}

// One ray's way through the tree.
class Traversal {
 public:
  Traversal(const Primitives& primitives, const Ray& ray)
      : primitives_(primitives), ray_(ray), slab_ray_(ray), sheared_ray_(ray) {}

  template <Query kQuery>
  Hit run(const std::vector<BvhNode>& nodes, const std::vector<BvhPacket>& packets) {
    if (!nodes.empty()) stack_.push(BvhChild::node(0));
    while (!stack_.empty()) {
      const StackEntry next = stack_.pop();
      if (next.t_near * kSlack > limit()) continue;
      if (next.child.is_packet()) {
        visit(packets[next.child.index()]);
        if (kQuery == Query::kAny && hit_.found()) break;
      } else {
        visit(nodes[next.child.index()]);
      }
    }
    return hit_;
  }

 private:
  // Finite, so that boxes beside a ray that is parallel to their sides, which begin at infinity, are beyond
  // it.
  float limit() const { return std::min({hit_.t, ray_.t_max, std::numeric_limits<float>::max()}); }

  void visit(const BvhNode& node) {
    // 0 * infinity is NaN, where the ray lies in the plane of a box's side: max and min then keep their
    // second argument, and that side does not count.
    Float8 near = Float8::broadcast(0), far = Float8::broadcast(limit());
    for (int axis = 0; axis < 3; ++axis) {
      near = max(slab_ray_.distance(node, slab_ray_.near_side[axis], axis), near);
      far = min(slab_ray_.distance(node, 1 - slab_ray_.near_side[axis], axis), far);
    }
    alignas(32) float t_near[BvhNode::kWidth];
    near.store(t_near);
    stack_.push_sorted(node, less_equal(near * Float8::broadcast(kSlack), far), t_near);
  }

  void visit(const BvhPacket& packet) {
    for (unsigned lanes = possible_hits(packet, sheared_ray_); lanes != 0; lanes &= lanes - 1) {
      const int lane = std::countr_zero(lanes);
      const auto found = intersect_triangle(sheared_ray_, corners(packet, lane));
      if (found) hit_.improve(ray_, {found->t, packet.primitives[lane], found->b1, found->b2});
    }
    for (unsigned lanes = packet.sphere_lanes; lanes != 0; lanes &= lanes - 1) {
      primitives_.intersect(packet.primitives[std::countr_zero(lanes)], ray_, hit_);
    }
  }

  static TriangleCorners corners(const BvhPacket& packet, int lane) {
    TriangleCorners corners;
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = {packet.corners[i][0][lane], packet.corners[i][1][lane], packet.corners[i][2][lane]};
    }
    return corners;
  }

  const Primitives& primitives_;
  const Ray& ray_;
  SlabRay slab_ray_;
  ShearedRay sheared_ray_;
  Hit hit_;
  Stack stack_;
};

}  // namespace

Hit Bvh::closest_hit(const Primitives& primitives, const Ray& ray) const {
  return Traversal(primitives, ray).run<Query::kClosest>(nodes_, packets_);
}

bool Bvh::any_hit(const Primitives& primitives, const Ray& ray) const {
  return Traversal(primitives, ray).run<Query::kAny>(nodes_, packets_).found();
}

}  // namespace tessera::core
