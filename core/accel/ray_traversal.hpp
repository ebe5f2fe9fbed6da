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

// The opacity of what a traversal hits: a scene, or an object in one of its instances.
class OpacityOf {
 public:
  // Without `hits` everything is opaque. `timed` is whether hits depend on the times of rays.
  explicit OpacityOf(const HitOpacity* hits = nullptr, bool timed = false) : hits_(hits), timed_(timed) {}
  OpacityOf inside(std::uint32_t instance) const {
    OpacityOf of_instance = *this;
    of_instance.instance_ = instance;
    return of_instance;
  }

  // Whether hits of the packet need at().
  template <Query kQuery>
  bool decides(const BvhPacket& packet) const {
    constexpr auto kThreshold =
        kQuery == Query::kClosest ? MaterialOpacity::kCutOut : MaterialOpacity::kPartial;
    return packet.opacity >= kThreshold && hits_ != nullptr;
  }
  // `hit` has neither an instance nor a time.
  Opacity at(Hit hit, float time) const {
    hit.instance = instance_;
    hit.time = timed_ ? time : 0;
    return hits_->at(hit);
  }

 private:
  const HitOpacity* hits_;
  bool timed_;
  std::uint32_t instance_ = kNoInstance;
};

// A visitor that counts nothing.
struct UncountedVisits {
  void node() const {}
  void packet() const {}
};

// AnyRay is Ray, or ObjectRay in the space of an object, which contains no instances.
template <typename AnyRay>
class RayTraversal {
 public:
  // `objects` are the trees of instanced objects.
  RayTraversal(const Primitives& primitives, const Bvh::Arrays* objects, const OpacityOf& opacity,
               const AnyRay& ray)
      : primitives_(primitives),
        objects_(objects),
        opacity_(opacity),
        ray_(ray),
        slab_ray_(ray),
        sheared_ray_(ray) {
    update_limit();
    stack_.clear();
  }

  // The best hit that is not transparent, or any opaque hit for kAny. For kClosest, `visits` is called for
  // each node and each packet visited.
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

  // For kAny, if nothing was hit: whether something partly opaque was met.
  bool is_partly_occluded() const { return partly_occluded_; }

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
    if (packet.kind == GeometryKind::kTriangle) return visit_triangles<kQuery>(packet);
    if constexpr (std::is_same_v<AnyRay, Ray>)
      if (packet.kind == GeometryKind::kInstance) return visit_instance<kQuery>(packet);
    visit_others<kQuery>(packet);
  }

  template <Query kQuery>
  void visit_triangles(const BvhPacket& packet) {
    const auto hits = hits_of_packet(sheared_ray_, packet);
    for (unsigned lanes = hits.lanes() & packet.lanes; lanes != 0; lanes &= lanes - 1) {
      const int lane = std::countr_zero(lanes);
      const float t = hits.t(lane);
      if (!improve<kQuery>(packet, {t, packet.primitives[lane], hits.b1(lane), hits.b2(lane)})) continue;
      update_limit();
    }
  }

  template <Query kQuery>
  void visit_others(const BvhPacket& packet) {
    for_each_line_hit(packet, primitives_, ray_, limit_,
                      [&](const Hit& hit) { improve<kQuery>(packet, hit); });
    update_limit();
  }

  // Whether the hit of a packet's primitive became the best.
  template <Query kQuery>
  bool improve(const BvhPacket& packet, const Hit& hit) {
    if (!opacity_.decides<kQuery>(packet)) return hit_.improve(ray_, hit);
    Hit best = hit_;
    if (!best.improve(ray_, hit)) return false;
    const Opacity opacity = opacity_.at(hit, ray_.time);
    if (opacity == Opacity::kTransparent) return false;
    if (kQuery == Query::kAny && opacity == Opacity::kPartial) {
      partly_occluded_ = true;
      return false;
    }
    hit_ = best;
    return true;
  }

  template <Query kQuery>
  void visit_instance(const BvhPacket& packet);

  const Primitives& primitives_;
  const Bvh::Arrays* objects_;
  const OpacityOf opacity_;
  const AnyRay& ray_;
  SlabRay<AnyRay> slab_ray_;
  ShearedRay sheared_ray_;
  float limit_;
  bool partly_occluded_ = false;
  Hit hit_;
  TraversalStack<StackEntry, kMaxStackSize> stack_;
};

template <typename AnyRay>
template <Query kQuery>
void RayTraversal<AnyRay>::visit_instance(const BvhPacket& packet) {
  const std::uint32_t number = primitives_.instance_number(packet.primitives[0]);
  const Instance& instance = primitives_.instance(number);
  const Bvh::Arrays& tree = objects_[instance.object];
  ObjectRay object_ray = primitives_.to_object(instance, ray_);
  object_ray.t_max =
      std::min(ray_.t_max, next_float_up(hit_.t));  // an equally near hit may still win the tie
  RayTraversal<ObjectRay> traversal(primitives_.object_of(instance), nullptr, opacity_.inside(number),
                                    object_ray);
  Hit found = traversal.template run<kQuery>(tree.nodes.data(), tree.packets.data());
  partly_occluded_ |= traversal.is_partly_occluded();
  if (!found.found()) return;
  found.instance = number;
  hit_.improve(ray_, found);
  update_limit();
}

}  // namespace tessera::core::accel
