// SPDX-License-Identifier: Apache-2.0
#include "core/accel/group_traversal.hpp"

#include <array>
#include <bit>

#include "core/accel/diverged_rays.hpp"
#include "core/accel/ray_traversal.hpp"
#include "core/accel/rays_in_object.hpp"
#include "core/accel/traversal_stack.hpp"
#include "core/base/prefetch.hpp"

namespace tessera::core::accel {
namespace {

// Approximate costs of tests in cycles, for choosing between them.
constexpr int kBoxVsVector = 9, kRayVsBoxes = 20, kTriangleVsVector = 24, kRayVsPacket = 28;
// Groups of at most this many rays diverge.
constexpr int kFewRays = 5;
// Smaller groups are not worth the setup cost in an object.
constexpr int kMinInObject = 8;

// A child to be visited, and the rays that meet its box.
struct GroupEntry {
  bool operator<(const GroupEntry& other) const { return t_near < other.t_near; }

  float t_near;  // a lower bound over the rays of the group
  BvhChild child;
  RaySet rays;
};

// AnyRay is Ray, or ObjectRay in the space of an object, which contains no instances. Keeps references.
template <Query kQuery, typename AnyRay>
class GroupTraversal {
 public:
  GroupTraversal(const GroupScene& scene, const RayColumns<AnyRay>& columns)
      : scene_(scene),
        columns_(columns),
        group_(columns),
        hits_(scene, columns, group_),
        diverged_(group_, scene.nodes, scene.packets) {}

  // The hits of the rays. For kAny only missing() and partly_occluded() are meaningful.
  const HitColumns& run() {
    stack_.clear();
    stack_.push({0, BvhChild::node(0), hits_.alive()});
    while (!stack_.empty()) {
      const GroupEntry entry = stack_.pop();
      const RaySet set = group_.reaching(entry.rays & going(), entry.t_near);
      if (set == 0) continue;
      if (entry.child.is_packet()) {
        visit(entry.child.index(), set);
      } else if (std::popcount(set) <= kFewRays) {
        for_each_ray(set, [&](std::size_t i) { keep(i, {entry.t_near, entry.child}); });
      } else {
        enter(scene_.nodes[entry.child.index()], set);
      }
    }
    go_on_alone();
    return hits_.finish();
  }

  // For kAny, after run: the rays that hit nothing opaque.
  RaySet missing() const { return hits_.alive(); }
  // For kAny: of those, the rays that met something partly opaque.
  RaySet partly_occluded() const { return hits_.partly_occluded(); }

 private:
  void enter(const BvhNode& node, RaySet set) {
    alignas(kVectorAlignment) float t_near[BvhNode::kWidth];
    unsigned met = group_.boxes_met(node, t_near);
    const int cost_by_box = std::popcount(met) * vectors_of(set) * kBoxVsVector;
    std::array<RaySet, BvhNode::kWidth> meeting;
    if (cost_by_box <= std::popcount(set) * kRayVsBoxes) {
      group_.rays_meeting(node, met, set, meeting);
    } else {
      met = group_.rays_meeting(node, set, meeting);
    }
    const std::size_t base = stack_.size();
    for_each_lane(met, [&](std::size_t lane) {
      const BvhChild child = node.children[lane];
      if (!child.is_packet() && std::popcount(meeting[lane]) <= kFewRays) {
        for_each_ray(meeting[lane], [&](std::size_t i) {
          keep(i, {group_.entry_into(node, lane, i), child});
        });
      } else if (meeting[lane] != 0) {
        prefetch_child(child);
        stack_.push_sorted(base, {t_near[lane], child, meeting[lane]});
      }
    });
  }

  void prefetch_child(BvhChild child) const {
    if (child.is_packet()) {
      prefetch(scene_.packets[child.index()]);
    } else {
      prefetch(scene_.nodes[child.index()]);
    }
  }

  void visit(std::uint32_t index, RaySet set) {
    const BvhPacket& packet = scene_.packets[index];
    if (packet.kind != GeometryKind::kTriangle) {
      visit_others(packet, set);
      return hits_.settle();
    }
    const int cost_together = std::popcount(packet.lanes) * vectors_of(set) * kTriangleVsVector;
    if (group_.can_filter() && cost_together <= std::popcount(set) * kRayVsPacket) {
      hits_.test_together(index, set);
    } else {
      hits_.test_each(index, set);
    }
  }

  // Tests primitives other than triangles at rest; the result for curves is known after hits_.settle().
  void visit_others(const BvhPacket& packet, RaySet set) {
    if constexpr (std::is_same_v<AnyRay, Ray>)
      if (packet.kind == GeometryKind::kInstance)
        return enter_instance(scene_.primitives.instance_number(packet.primitives[0]), set & hits_.alive());
    if (packet.kind == GeometryKind::kSphere) return hits_.test_spheres(packet, set);
    if (packet.kind == GeometryKind::kCurve) return hits_.test_curves_later(packet, set);
    hits_.test_others(packet, set);
  }

  void enter_instance(std::uint32_t number, RaySet set) {
    const Instance& instance = scene_.primitives.instance(number);
    const Bvh::Arrays& tree = scene_.objects[instance.object];
    const GroupScene object{scene_.primitives.object_of(instance), nullptr, tree.nodes.data(),
                            tree.packets.data(), scene_.opacity.inside(number)};
    const RaysInObject rays(scene_.primitives, instance, columns_, set);
    rays.for_each_octant([&](RaySet octant) {
      if (std::popcount(octant) >= kMinInObject) {
        trace_together(object, number, rays, octant);
      } else {
        for_each_ray(octant, [&](std::size_t i) { trace_alone(object, number, rays, i); });
      }
    });
  }

  void trace_together(const GroupScene& object, std::uint32_t number, const RaysInObject& rays, RaySet set) {
    std::array<std::uint8_t, kGroupSize> place,
        ray_at;  // maps rays of this group to positions in the set, and back
    std::size_t count = 0;
    for_each_ray(set, [&](std::size_t i) {
      place[i] = static_cast<std::uint8_t>(count);
      ray_at[count++] = static_cast<std::uint8_t>(i);
    });
    const RayColumns<ObjectRay> columns(
        count, [&](std::size_t k) { return rays.ray(ray_at[k], hits_.reach(ray_at[k])); });
    GroupTraversal<kQuery, ObjectRay> traversal(object, columns);
    const HitColumns& found = traversal.run();
    if (kQuery == Query::kAny) {
      hits_.occlude_partly(spread(traversal.partly_occluded(), ray_at));
      return hits_.occlude(spread(columns.all() & ~traversal.missing(), ray_at));
    }
    RaySet hit = 0;
    for (std::size_t k = 0; k < count; ++k) hit |= RaySet{found.found(k)} << ray_at[k];
    improve_all(hit, number, [&](std::size_t i) { return found[place[i]]; });
  }

  void trace_alone(const GroupScene& object, std::uint32_t number, const RaysInObject& rays, std::size_t i) {
    const Hit found = alone(object, rays.ray(i, hits_.reach(i)), i);
    if (found.found()) improve_all(RaySet{1} << i, number, [&](std::size_t) { return found; });
  }

  // What ray i, which is `ray` there, hits in a scene or an object.
  template <typename RayThere>
  Hit alone(const GroupScene& scene, const RayThere& ray, std::size_t i) {
    RayTraversal traversal(scene.primitives, scene.objects, scene.opacity, ray);
    const Hit found = traversal.template run<kQuery>(scene.nodes, scene.packets);
    hits_.occlude_partly(RaySet{traversal.is_partly_occluded()} << i);
    return found;
  }

  // Improves results by hits in an instance.
  template <typename HitOf>
  void improve_all(RaySet set, std::uint32_t instance, const HitOf& hit_of) {
    hits_.improve_all(set, [&](std::size_t i) {
      Hit hit = hit_of(i);
      hit.instance = instance;
      return hit;
    });
  }

  // Bit k of `set` becomes bit bit_of[k].
  static RaySet spread(RaySet set, const std::array<std::uint8_t, kGroupSize>& bit_of) {
    RaySet spread = 0;
    for_each_ray(set, [&](std::size_t k) { spread |= RaySet{1} << bit_of[k]; });
    return spread;
  }

  // Ray i visits a node individually, after the group has finished.
  void keep(std::size_t i, StackEntry entry) {
    if (!diverged_.keep(i, entry)) restart(i);
  }

  // Traverses the rays that have diverged from the group.
  void go_on_alone() {
    diverged_.run([&](std::size_t i, std::uint32_t packet) { visit_alone(packet, i); },
                  [&] {
                    hits_.settle();
                    return going();
                  },
                  [&](std::size_t i) { restart(i); });
  }

  void visit_alone(std::uint32_t index, std::size_t i) {
    const BvhPacket& packet = scene_.packets[index];
    if (packet.kind == GeometryKind::kTriangle) {
      hits_.test_later(i, index);
    } else {
      visit_others(packet, RaySet{1} << i);
    }
  }

  // Ray i traverses the whole tree individually.
  void restart(std::size_t i) {
    const Hit found = alone(scene_, columns_.ray(i), i);
    if (found.found()) hits_.improve_all(RaySet{1} << i, [&](std::size_t) { return found; });
    through_ |= RaySet{1} << i;
  }

  // The rays that still have entries to visit.
  RaySet going() const { return hits_.alive() & ~through_; }

  const GroupScene& scene_;
  const RayColumns<AnyRay>& columns_;
  RayGroup<AnyRay> group_;
  GroupHits<kQuery, AnyRay> hits_;
  TraversalStack<GroupEntry, kMaxStackSize> stack_;
  DivergedRays<kQuery, AnyRay> diverged_;
  RaySet through_ = 0;  // rays that have traversed the whole tree individually
};

RayColumns<Ray> columns_of(const GroupScene& scene, ColumnsView<const Ray> rays,
                           std::span<const std::uint16_t> order) {
  return {rays, order, scene.primitives.has_motion()};
}

}  // namespace

void trace_closest(const GroupScene& scene, ColumnsView<const Ray> rays, std::span<const std::uint16_t> order,
                   ColumnsView<Hit> hits) {
  const RayColumns<Ray> columns = columns_of(scene, rays, order);
  GroupTraversal<Query::kClosest, Ray> traversal(scene, columns);
  traversal.run().store(order, hits);
}

void trace_any(const GroupScene& scene, ColumnsView<const Ray> rays, std::span<const std::uint16_t> order,
               std::span<Occlusion> occluded) {
  const RayColumns<Ray> columns = columns_of(scene, rays, order);
  GroupTraversal<Query::kAny, Ray> traversal(scene, columns);
  traversal.run();
  const RaySet missing = traversal.missing(), partial = traversal.partly_occluded();
  const auto has = [](RaySet set, std::size_t i) { return (set >> i & 1) != 0; };
  for (std::size_t i = 0; i < order.size(); ++i)
    occluded[order[i]] = !has(missing, i)  ? Occlusion::kFull
                         : has(partial, i) ? Occlusion::kPartial
                                           : Occlusion::kNone;
}

}  // namespace tessera::core::accel
