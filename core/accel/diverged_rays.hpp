// SPDX-License-Identifier: Apache-2.0
// Traversal of rays that have diverged from their group. The rays are interleaved: the node or packet that
// a ray needs next is prefetched while other rays advance, and packets are tested for many rays in a row.
// This hides the latency of memory and of dependent arithmetic.
#pragma once

#include <array>
#include <cassert>
#include <cstdint>
#include <utility>

#include "core/accel/ray_group.hpp"
#include "core/accel/ray_traversal.hpp"
#include "core/accel/traversal_stack.hpp"
#include "core/base/prefetch.hpp"

namespace tessera::core::accel {

// AnyRay is Ray or ObjectRay.
template <Query kQuery, typename AnyRay>
class DivergedRays {
 public:
  // Keeps references.
  DivergedRays(const RayGroup<AnyRay>& group, const BvhNode* nodes, const BvhPacket* packets)
      : group_(group), nodes_(nodes), packets_(packets) {}

  // Schedules a node (not a packet) for ray i. If there is no room, returns false and clears the ray's
  // stack.
  bool keep(std::size_t i, StackEntry entry) {
    RayStack& stack = stacks_[i];
    if ((diverged_ >> i & 1) == 0) stack.clear();
    diverged_ |= RaySet{1} << i;
    if (!stack.has_room()) return forget(i);
    stack.push_sorted(kQuery == Query::kClosest ? 0 : stack.size(), entry);
    return true;
  }

  // Traverses all kept entries. Calls test(i, packet) for each packet that ray i reaches. After some of
  // these it calls settle(), which updates the group's ray limits and returns the rays that remain active.
  // Calls restart(i) if the stack of ray i overflows.
  template <typename Test, typename Settle, typename BeginAnew>
  void run(const Test& test, const Settle& settle, const BeginAnew& restart) {
    for_each_ray(settle() & diverged_, [&](std::size_t i) { go_on(i); });
    while (at_node_ != 0 || reached_count_ > 0) {
      for_each_ray(std::exchange(at_node_, 0), [&](std::size_t i) {
        if (!enter(nodes_[next_[i]], i)) restart(i);
      });
      if (at_node_ != 0 && reached_count_ < kManyPackets) continue;
      const std::size_t count = std::exchange(reached_count_, 0);
      for (std::size_t k = 0; k < count; ++k) test(reached_[k].ray, reached_[k].packet);
      const RaySet alive = settle();
      at_node_ &= alive;
      if (kQuery == Query::kAny) continue;
      // Each ray reaches at most one packet, which overwrites an entry that has already been read.
      for (std::size_t k = 0; k < count; ++k) go_on(reached_[k].ray);
    }
  }

 private:
  // The capacity is small, because there are many rays.
  using RayStack = TraversalStack<StackEntry, 64>;

  // A packet that a ray is to be tested against.
  struct Reached {
    std::uint32_t ray, packet;
  };

  bool forget(std::size_t i) {
    stacks_[i].clear();
    return false;
  }

  // Pops the next entry from the ray's stack.
  void go_on(std::size_t i) {
    BvhChild next;
    if (stacks_[i].pop(group_.limit(i), next)) schedule_node(i, next);
  }

  // Prefetches what the ray visits next.
  void schedule_node(std::size_t i, BvhChild next) {
    if (next.is_packet()) return enqueue_leaf(i, next.index());
    prefetch(nodes_[next.index()]);
    next_[i] = next.index();
    at_node_ |= RaySet{1} << i;
  }
  void enqueue_leaf(std::size_t i, std::uint32_t packet) {
    assert(reached_count_ < reached_.size());
    prefetch(packets_[packet]);
    reached_[reached_count_++] = {static_cast<std::uint32_t>(i), packet};
  }

  // Returns false if there is no room for the node's children.
  bool enter(const BvhNode& node, std::size_t i) {
    RayStack& stack = stacks_[i];
    if (!stack.has_room()) return forget(i);
    alignas(kVectorAlignment) float t_near[BvhNode::kWidth];
    const unsigned met = group_.boxes_met_by(i, node, t_near);
    if (kQuery == Query::kAny) {
      // The ray advances before the packets that it has reached are tested.
      for_each_lane(push_nodes(stack, node, met),
                    [&](std::size_t lane) { enqueue_leaf(i, node.children[lane].index()); });
      go_on(i);
    } else if (BvhChild next; next_nearest(stack, node, met, t_near, group_.limit(i), next)) {
      schedule_node(i, next);
    }
    return true;
  }

  // Enough packets that their tests do not wait for each other. Shadow rays test at once, because a hit
  // saves the remaining nodes.
  static constexpr std::size_t kManyPackets = kQuery == Query::kAny ? 1 : 16;

  const RayGroup<AnyRay>& group_;
  const BvhNode* const nodes_;
  const BvhPacket* const packets_;
  RaySet diverged_ = 0;                      // rays that have kept entries
  RaySet at_node_ = 0;                       // rays that visit node next_[i] in the next round
  std::array<RayStack, kGroupSize> stacks_;  // of the rays in diverged_
  std::array<std::uint32_t, kGroupSize> next_;
  std::size_t reached_count_ = 0;
  // Room for one packet of each ray; for kAny, for all packets of one node of each ray, since these are
  // tested before the next nodes.
  std::array<Reached, (kQuery == Query::kAny ? BvhNode::kWidth : 1) * kGroupSize> reached_;
};

}  // namespace tessera::core::accel
