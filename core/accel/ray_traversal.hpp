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

#include "core/accel/bvh.hpp"
#include "core/accel/bvh_layout.hpp"
#include "core/accel/packet_hits.hpp"
#include "core/accel/slab_test.hpp"
#include "core/accel/traversal_stack.hpp"
#include "core/accel/triangle_hits.hpp"
#include "core/geometry/primitives.hpp"
#include "core/math/simd.hpp"

namespace tessera::core::accel {

enum class Query { kClosest, kAny };

inline TriangleHitsOf<DoubleHalf> hits_of_packet(const ShearedRay& ray, const BvhPacket& packet) {
  const int axes[3] = {ray.x_axis, ray.y_axis, ray.z_axis};
  return TriangleHitsOf<DoubleHalf>(ShearedRaysOf<DoubleHalf>(ray), [&](int corner, int axis) {
    return DoubleHalf::load(packet.corners[corner][axes[axis]]);
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
    stack_.clear();
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

  void find_any(const BvhNode* nodes, const BvhPacket* packets) {
    for (BvhChild next; stack_.pop(limit_, next);) {
      const BvhNode& node = nodes[next.index()];
      alignas(kVectorAlignment) float t_near[BvhNode::kWidth];
      const unsigned met = slab_ray_.boxes_met(node, limit_, t_near);
      for (unsigned lanes = push_nodes(stack_, node, met); lanes != 0; lanes &= lanes - 1) {
        visit<Query::kAny>(packets[node.children[static_cast<std::size_t>(std::countr_zero(lanes))].index()]);
        if (hit_.found()) return;
      }
    }
  }

  // Stores the next child to visit in `next`; returns false if there is none.
  bool enter(const BvhNode& node, BvhChild& next) {
    alignas(kVectorAlignment) float t_near[BvhNode::kWidth];
    const unsigned met = slab_ray_.boxes_met(node, limit_, t_near);
    return next_nearest(stack_, node, met, t_near, limit_, next);
  }

  template <Query kQuery>
  void visit(const BvhPacket& packet) {
    if (packet.kind == GeometryKind::kTriangle) return visit_triangles(packet);
    if constexpr (std::is_same_v<AnyRay, Ray>)
      if (packet.kind == GeometryKind::kInstance) return visit_instance<kQuery>(packet);
    visit_others(packet);
  }

  void visit_triangles(const BvhPacket& packet) {
    const auto hits = hits_of_packet(sheared_ray_, packet);
    for (unsigned lanes = hits.lanes() & packet.lanes; lanes != 0; lanes &= lanes - 1) {
      const int lane = std::countr_zero(lanes);
      const float t = hits.t(lane);
      if (!hit_.improve(ray_, {t, packet.primitives[lane], hits.b1(lane), hits.b2(lane)})) continue;
      update_limit();
    }
  }

  void visit_others(const BvhPacket& packet) {
    if (packet.kind == GeometryKind::kCurve) prefetch_curves(packet, primitives_);
    for_each_line_hit(packet, primitives_, ray_, [this](const Hit& hit) { hit_.improve(ray_, hit); });
    update_limit();
  }

  template <Query kQuery>
  void visit_instance(const BvhPacket& packet) {
    enter_instance<kQuery>(primitives_, objects_, primitives_.instance_number(packet.primitives[0]), ray_,
                           hit_);
    update_limit();
  }

  const Primitives& primitives_;
  const Bvh::Arrays* objects_;
  const AnyRay& ray_;
  SlabRay<AnyRay> slab_ray_;
  ShearedRay sheared_ray_;
  float limit_;
  Hit hit_;
  TraversalStack<StackEntry, kMaxStackSize> stack_;
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

}  // namespace tessera::core::accel
