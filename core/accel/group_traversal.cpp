#include "core/accel/group_traversal.hpp"

#include <array>
#include <bit>

#include "core/accel/ray_traversal.hpp"

namespace tessera::core {
namespace {

// What tests cost, in cycles, as far as choosing between them goes.
constexpr int kBoxVsVector = 9, kRayVsBoxes = 20, kTriangleVsVector = 24, kRayVsPacket = 28;
// From here on rays go alone.
constexpr int kFewRays = 3;

// A child yet to be visited, and the rays that meet its box.
struct GroupEntry {
  float t_near;  // no ray of the group enters before
  BvhChild child;
  RaySet rays;
};

// What is yet to be visited, nearest on top.
class GroupStack {
 public:
  bool empty() const { return size_ == 0; }
  const GroupEntry& pop() { return entries_[--size_]; }

  // Entries that are pushed one after the other with the same `base`, the size before the first of them, end
  // up sorted.
  std::size_t size() const { return size_; }
  void push(std::size_t base, const GroupEntry& entry) {
    std::size_t slot = size_++;
    for (; slot > base && entries_[slot - 1].t_near < entry.t_near; --slot)
      entries_[slot] = entries_[slot - 1];
    entries_[slot] = entry;
  }

 private:
  std::array<GroupEntry, kMaxStackSize> entries_;
  std::size_t size_ = 0;
};

template <Query kQuery>
class GroupTraversal {
 public:
  GroupTraversal(const GroupScene& scene, std::span<const Ray> rays, std::span<const std::uint32_t> order)
      : scene_(scene), columns_(rays, order), group_(columns_), hits_(scene, rays, order, columns_, group_) {}

  std::span<const Hit> run() {
    stack_.push(0, {0, BvhChild::node(0), hits_.alive()});
    while (!stack_.empty()) {
      const GroupEntry entry = stack_.pop();
      const RaySet set = group_.reaching(entry.rays & hits_.alive(), entry.t_near);
      if (set == 0) continue;
      if (entry.child.is_packet()) {
        visit(entry.child.index(), set);
      } else if (std::popcount(set) <= kFewRays) {
        for_each_ray(set, [&](std::size_t i) { go_alone(i, entry.child); });
      } else {
        enter(scene_.nodes[entry.child.index()], set);
      }
    }
    return kQuery == Query::kClosest ? hits_.finish() : std::span<const Hit>();
  }

  // For kAny, after run: the rays that hit nothing.
  RaySet missing() const { return hits_.alive(); }

 private:
  void enter(const BvhNode& node, RaySet set) {
    alignas(32) float t_near[BvhNode::kWidth];
    unsigned met = group_.boxes_met(node, t_near);
    const int cost_by_box = std::popcount(met) * vectors_of(set) * kBoxVsVector;
    std::array<RaySet, BvhNode::kWidth> meeting;
    if (cost_by_box <= std::popcount(set) * kRayVsBoxes) {
      group_.rays_meeting(node, met, set, meeting);
    } else {
      met = group_.rays_meeting(node, set, meeting);
    }
    const std::size_t base = stack_.size();
    for (; met != 0; met &= met - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(met));
      if (meeting[lane] != 0) stack_.push(base, {t_near[lane], node.children[lane], meeting[lane]});
    }
  }

  void visit(std::uint32_t index, RaySet set) {
    const BvhPacket& packet = scene_.packets[index];
    if (packet.instance_lanes != 0)
      return for_each_ray(set, [&](std::size_t i) { go_alone(i, BvhChild::packet(index)); });
    if (packet.sphere_lanes != 0) hits_.test_spheres(packet, set);
    if (packet.triangle_lanes == 0) return;
    const int cost_together = std::popcount(packet.triangle_lanes) * vectors_of(set) * kTriangleVsVector;
    if (group_.can_filter() && cost_together <= std::popcount(set) * kRayVsPacket) {
      hits_.test_together(index, set);
    } else {
      hits_.test_each(packet, set);
    }
  }

  void go_alone(std::size_t i, BvhChild child) {
    hits_.improve(i, [&](const Ray& ray, const ShearedGroup& sheared, const Hit& best) {
      RayTraversal alone(
          scene_.primitives, scene_.objects, ray, best, [&] { return group_.slab_ray(i); },
          [&] { return sheared.ray(i); });
      return alone.template run<kQuery>(scene_.nodes, scene_.packets, child);
    });
  }

  const GroupScene& scene_;
  const RayColumns columns_;
  RayGroup group_;
  GroupHits<kQuery> hits_;
  GroupStack stack_;
};

}  // namespace

void trace_closest(const GroupScene& scene, std::span<const Ray> rays, std::span<const std::uint32_t> order,
                   std::span<Hit> hits) {
  GroupTraversal<Query::kClosest> traversal(scene, rays, order);
  const std::span<const Hit> found = traversal.run();
  for (std::size_t i = 0; i < order.size(); ++i) hits[order[i]] = found[i];
}

void trace_any(const GroupScene& scene, std::span<const Ray> rays, std::span<const std::uint32_t> order,
               std::span<std::uint8_t> occluded) {
  GroupTraversal<Query::kAny> traversal(scene, rays, order);
  traversal.run();
  for (std::size_t i = 0; i < order.size(); ++i)
    occluded[order[i]] = (traversal.missing() >> i & 1) != 0 ? 0 : 1;
}

}  // namespace tessera::core
