// SPDX-License-Identifier: Apache-2.0
// Traversal of a single ray. For the closest hit, nodes are visited nearest first, from a stack, and culled
// if they cannot hold a better hit; for any hit, in any order.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <type_traits>

#include "core/accel/binary_bvh.hpp"
#include "core/accel/box_test.hpp"
#include "core/accel/bvh.hpp"
#include "core/accel/bvh_layout.hpp"
#include "core/accel/moving_triangles.hpp"
#include "core/accel/triangle_hits.hpp"
#include "core/accel/tube_test.hpp"
#include "core/geometry/primitives.hpp"
#include "core/math/simd.hpp"

namespace tessera::core {

enum class Query { kClosest, kAny };

// A ray's direction prepared for box tests.
struct SlabDirections {
  // Returns whether a box's upper side is the near one along the axis.
  bool prepare(int axis, float inverse) {
    const int near = std::signbit(inverse) ? BvhNode::kUpper : BvhNode::kLower;
    near_inverse[axis] = Float8::broadcast(inverse);
    far_inverse[axis] = Float8::broadcast(inverse * kBoxSlack);
    near_side[axis] = 3 * near + axis;
    far_side[axis] = 3 * (1 - near) + axis;
    return near == BvhNode::kUpper;
  }

  Float8 near_inverse[3], far_inverse[3];
  std::int64_t near_side[3], far_side[3];  // rows of BvhNode::bounds
};

// A ray prepared for box tests.
template <typename AnyRay>
struct SlabRay;

template <>
struct SlabRay<Ray> : SlabDirections {
  explicit SlabRay(const Ray& ray) {
    for (int axis = 0; axis < 3; ++axis) {
      prepare(axis, 1 / ray.direction[axis]);
      origin[axis] = Float8::broadcast(ray.origin[axis]);
    }
  }

  Float8 origin_for_near(int axis) const { return origin[axis]; }
  Float8 origin_for_far(int axis) const { return origin[axis]; }

  Float8 origin[3];
};

// The origin, which is in double, is rounded so that boxes begin earlier and end later.
template <>
struct SlabRay<ObjectRay> : SlabDirections {
  explicit SlabRay(const ObjectRay& ray) {
    for (int axis = 0; axis < 3; ++axis) {
      const bool descends = prepare(axis, static_cast<float>(1 / ray.direction[axis]));
      const float below = rounded_down(ray.origin[axis]), above = -rounded_down(-ray.origin[axis]);
      near_origin[axis] = Float8::broadcast(descends ? below : above);
      far_origin[axis] = Float8::broadcast(descends ? above : below);
    }
  }

  Float8 origin_for_near(int axis) const { return near_origin[axis]; }
  Float8 origin_for_far(int axis) const { return far_origin[axis]; }

  Float8 near_origin[3], far_origin[3];
};

// A child to be visited and the distance at which the ray enters its box, packed into one integer that
// compares like the non-negative distance.
class StackEntry {
 public:
  StackEntry() = default;
  constexpr StackEntry(float t_near, BvhChild child)
      : key_(std::uint64_t{std::bit_cast<std::uint32_t>(t_near)} << 32 |
             std::bit_cast<std::uint32_t>(child)) {}

  float t_near() const { return std::bit_cast<float>(static_cast<std::uint32_t>(key_ >> 32)); }
  BvhChild child() const { return std::bit_cast<BvhChild>(static_cast<std::uint32_t>(key_)); }
  bool operator<(const StackEntry& other) const { return key_ < other.key_; }

 private:
  std::uint64_t key_;  // uninitialised, so that creating a stack of these costs nothing
};

// Each level of the tree leaves at most kWidth - 1 children on the stack.
inline constexpr std::size_t kMaxStackSize = 1 + (BvhNode::kWidth - 1) * (kMaxBinaryDepth + 1);

// The entries to be visited; the nearest is on top if entries are pushed sorted.
class Stack {
 public:
  // Pops the next entry that begins before `limit`; returns false if there is none.
  bool pop(float limit, BvhChild& child) {
    while (size_ > 0) {
      const StackEntry top = entries_[--size_];
      child = top.child();
      if (top.t_near() <= limit) return true;
    }
    return false;
  }

  void push(StackEntry entry) { entries_[size_++] = entry; }

  // Pushes the lanes of `node` that are in `mask` with equal distances.
  void push_unsorted(const BvhNode& node, unsigned mask) {
    for (; mask != 0; mask &= mask - 1)
      push({0, node.children[static_cast<std::size_t>(std::countr_zero(mask))]});
  }

  // Pushes the lanes of `node` that are in `mask`, the nearest last.
  void push_sorted(const BvhNode& node, unsigned mask, const float* t_near) {
    const std::size_t base = size_;
    for (; mask != 0; mask &= mask - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(mask));
      const StackEntry entry(t_near[lane], node.children[lane]);
      std::size_t slot = size_++;
      for (; slot > base && entries_[slot - 1] < entry; --slot) entries_[slot] = entries_[slot - 1];
      entries_[slot] = entry;
    }
  }

 private:
  std::array<StackEntry, kMaxStackSize> entries_;
  std::size_t size_ = 0;
};

inline TriangleHitsOf<Double4> hits_of_packet(const ShearedRay& ray, const BvhPacket& packet) {
  const int axes[3] = {ray.x_axis, ray.y_axis, ray.z_axis};
  return TriangleHitsOf<Double4>(ShearedRaysOf<Double4>(ray), [&](int corner, int axis) {
    return Double4::load(packet.corners[corner][axes[axis]]);
  });
}

// A visitor that counts nothing.
struct UncountedVisits {
  void node() const {}
  void packet() const {}
};

// Improves `hit` by the hits in an instance, given by its index among all instances. For kAny only whether
// anything is found matters. `objects` are the trees of the objects of `scene`.
template <Query kQuery>
void enter_instance(const Primitives& scene, const Bvh::Arrays* objects, std::uint32_t number, const Ray& ray,
                    Hit& hit);

// AnyRay is Ray, or ObjectRay in the space of an object, which contains no instances.
template <typename AnyRay>
class RayTraversal {
 public:
  // `objects` are the trees of instanced objects.
  RayTraversal(const Primitives& primitives, const Bvh::Arrays* objects, const AnyRay& ray)
      : primitives_(primitives), objects_(objects), ray_(ray), slab_ray_(ray), sheared_ray_(ray) {
    update_limit();
  }

  // The best hit, or any hit for kAny. For kClosest, `visits` is called for each node and each packet
  // visited.
  template <Query kQuery, typename Visits = UncountedVisits>
  Hit run(const BvhNode* nodes, const BvhPacket* packets, Visits visits = {}) {
    stack_.push({0, BvhChild::node(0)});
    if constexpr (kQuery == Query::kClosest) {
      find_closest(nodes, packets, visits);
    } else {
      find_any(nodes, packets);
    }
    return hit_;
  }

 private:
  void update_limit() { limit_ = box_limit(std::min(hit_.t, ray_.t_max)); }

  template <typename Visits>
  void find_closest(const BvhNode* nodes, const BvhPacket* packets, Visits visits) {
    for (BvhChild next; stack_.pop(limit_, next);) {
      while (!next.is_packet()) {
        visits.node();
        if (!enter(nodes[next.index()], next)) return;
      }
      visits.packet();
      visit<Query::kClosest>(packets[next.index()]);
    }
  }

  // A ray without a hit must visit everything that it meets, so entries are not sorted. Packets are tested
  // where they are met, which overlaps their latency with that of the next node.
  void find_any(const BvhNode* nodes, const BvhPacket* packets) {
    for (BvhChild next; stack_.pop(limit_, next);) {
      const BvhNode& node = nodes[next.index()];
      alignas(32) float t_near[BvhNode::kWidth];
      const unsigned met = intersect_boxes_scalar(node, t_near), packet_lanes = node.packet_lanes();
      stack_.push_unsorted(node, met & ~packet_lanes);
      for (unsigned lanes = met & packet_lanes; lanes != 0; lanes &= lanes - 1) {
        visit<Query::kAny>(packets[node.children[static_cast<std::size_t>(std::countr_zero(lanes))].index()]);
        if (hit_.found()) return;
      }
    }
  }

  // Stores the next child to visit in `next`: the nearest child that the ray meets, or else an entry from
  // the stack. Returns false if there is none.
  bool enter(const BvhNode& node, BvhChild& next) {
    alignas(32) float t_near[BvhNode::kWidth];
    const unsigned mask = intersect_boxes_scalar(node, t_near);
    if (mask == 0) return stack_.pop(limit_, next);

    const auto first = static_cast<std::size_t>(std::countr_zero(mask));
    next = node.children[first];
    const unsigned others = mask & (mask - 1);
    if (others == 0) return true;
    if ((others & (others - 1)) != 0) {
      stack_.push_sorted(node, mask, t_near);
      return stack_.pop(limit_, next);
    }
    const auto second = static_cast<std::size_t>(std::countr_zero(others));
    const StackEntry a(t_near[first], next), b(t_near[second], node.children[second]);
    stack_.push(std::max(a, b));
    next = std::min(a, b).child();
    return true;
  }

  // The mask of boxes that the ray meets before the limit, and their distances.
  unsigned intersect_boxes_scalar(const BvhNode& node, float* t_near) const {
    unsigned met = 0;
    for (int lane = 0; lane < BvhNode::kWidth; lane += 8)
      met |= intersect_boxes(node, lane, t_near + lane) << lane;
    return met;
  }

  // Tests the boxes from `lane` on.
  unsigned intersect_boxes(const BvhNode& node, int lane, float* t_near) const {
    // 0 * infinity is NaN if the ray lies in the plane of a box's side. max and min then return their
    // second argument, which ignores that side.
    Float8 near = Float8::broadcast(0), far = Float8::broadcast(limit_);
    for (int axis = 0; axis < 3; ++axis) {
      const Float8 near_plane = Float8::load(node.bounds[slab_ray_.near_side[axis]] + lane);
      const Float8 far_plane = Float8::load(node.bounds[slab_ray_.far_side[axis]] + lane);
      near = max((near_plane - slab_ray_.origin_for_near(axis)) * slab_ray_.near_inverse[axis], near);
      far = min((far_plane - slab_ray_.origin_for_far(axis)) * slab_ray_.far_inverse[axis], far);
    }
    near.store(t_near);
    return less_equal(near, far);
  }

  template <Query kQuery>
  void visit(const BvhPacket& packet) {
    if (packet.triangle_lanes != 0) visit_triangles(packet);
    if ((packet.sphere_lanes | packet.quadric_lanes | packet.moving_lanes) != 0) visit_others(packet);
    if (packet.curve_lanes != 0) visit_curves(packet);
    if constexpr (std::is_same_v<AnyRay, Ray>)
      if (packet.instance_lanes != 0) visit_instances<kQuery>(packet);
  }

  void visit_triangles(const BvhPacket& packet) {
    const auto hits = hits_of_packet(sheared_ray_, packet);
    for (unsigned lanes = hits.lanes() & packet.triangle_lanes; lanes != 0; lanes &= lanes - 1) {
      const int lane = std::countr_zero(lanes);
      const float t = hits.t(lane);
      if (!hit_.improve(ray_, {t, packet.primitives[lane], hits.b1(lane), hits.b2(lane)})) continue;
      update_limit();
    }
  }

  void visit_curves(const BvhPacket& packet) {
    prefetch_curves(packet, primitives_);
    for (unsigned near = curves_near(packet, ObjectRay(ray_)); near != 0; near &= near - 1) {
      const int lane = std::countr_zero(near);
      primitives_.intersect_curve(packet.primitives[lane], source_of(packet, lane), ray_, hit_);
    }
    update_limit();
  }

  // Tests spheres, disks, cylinders and moving triangles.
  void visit_others(const BvhPacket& packet) {
    for (unsigned lanes = packet.sphere_lanes | packet.quadric_lanes; lanes != 0; lanes &= lanes - 1) {
      primitives_.intersect(packet.primitives[std::countr_zero(lanes)], ray_, hit_);
    }
    if (packet.moving_lanes != 0)
      for_each_moving_hit(packet, primitives_, ray_, [this](const Hit& hit) { hit_.improve(ray_, hit); });
    update_limit();
  }

  template <Query kQuery>
  void visit_instances(const BvhPacket& packet) {
    for (unsigned lanes = packet.instance_lanes; lanes != 0; lanes &= lanes - 1) {
      const std::uint32_t primitive = packet.primitives[std::countr_zero(lanes)];
      enter_instance<kQuery>(primitives_, objects_, primitives_.instance_number(primitive), ray_, hit_);
    }
    update_limit();
  }

  const Primitives& primitives_;
  const Bvh::Arrays* objects_;
  const AnyRay& ray_;
  SlabRay<AnyRay> slab_ray_;
  ShearedRay sheared_ray_;
  float limit_;
  Hit hit_;
  Stack stack_;
};

template <Query kQuery>
void enter_instance(const Primitives& scene, const Bvh::Arrays* objects, std::uint32_t number, const Ray& ray,
                    Hit& hit) {
  const Instance& instance = scene.instance(number);
  const Bvh::Arrays& tree = objects[instance.object];
  ObjectRay object_ray = scene.to_object(instance, ray);
  object_ray.t_max = std::min(ray.t_max, next_float_up(hit.t));  // an equally near hit may still win the tie
  Hit found = RayTraversal(scene.object_of(instance), nullptr, object_ray)
                  .template run<kQuery>(tree.nodes.data(), tree.packets.data());
  if (!found.found()) return;
  found.instance = number;
  hit.improve(ray, found);
}

}  // namespace tessera::core
