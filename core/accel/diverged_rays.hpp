// SPDX-License-Identifier: Apache-2.0
// Traversal of rays that have diverged from their group. The rays are interleaved: the node or packet that
// a ray needs next is prefetched while other rays advance, and packets are tested for many rays in a row.
// This hides the latency of memory and of dependent arithmetic.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstdint>
#include <utility>

#include "core/accel/ray_group.hpp"
#include "core/accel/ray_traversal.hpp"
#include "core/base/prefetch.hpp"

namespace tessera::core {

// A traversal stack for each ray; the nearest entry is on top if entries are pushed sorted. The capacity is
// small, because there are many rays.
class RayStacks {
 public:
  // Whether the children of one more node fit.
  bool has_room(std::size_t i) const { return sizes_[i] <= kCapacity - BvhNode::kWidth; }
  std::size_t size(std::size_t i) const { return sizes_[i]; }
  void clear(std::size_t i) { sizes_[i] = 0; }

  void push(std::size_t i, StackEntry entry) { entries_[i][sizes_[i]++] = entry; }
  // Inserts among the entries from `base` on, keeping the nearest last.
  void push_sorted(std::size_t i, std::size_t base, StackEntry entry) {
    std::size_t slot = sizes_[i]++;
    for (; slot > base && entries_[i][slot - 1] < entry; --slot) entries_[i][slot] = entries_[i][slot - 1];
    entries_[i][slot] = entry;
  }

  // Pops the next entry that begins before `limit`; returns false if there is none.
  bool pop(std::size_t i, float limit, BvhChild& child) {
    for (std::size_t size = sizes_[i]; size > 0;) {
      const StackEntry top = entries_[i][--size];
      if (top.t_near() > limit) continue;
      child = top.child();
      sizes_[i] = static_cast<std::uint8_t>(size);
      return true;
    }
    sizes_[i] = 0;
    return false;
  }

 private:
  static constexpr std::size_t kCapacity = 64;

  std::array<std::uint8_t, kGroupSize> sizes_{};
  std::array<std::array<StackEntry, kCapacity>, kGroupSize> entries_;
};

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
    if (!stacks_.has_room(i)) return forget(i);
    diverged_ |= RaySet{1} << i;
    if (kQuery == Query::kClosest) {
      stacks_.push_sorted(i, 0, entry);
    } else {
      stacks_.push(i, entry);
    }
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
  // A packet that a ray is to be tested against.
  struct Reached {
    std::uint32_t ray, packet;
  };

  bool forget(std::size_t i) {
    stacks_.clear(i);
    return false;
  }

  // Pops the next entry from the ray's stack.
  void go_on(std::size_t i) {
    BvhChild next;
    if (stacks_.pop(i, group_.limit(i), next)) schedule_node(i, next);
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
    if (!stacks_.has_room(i)) return forget(i);
    alignas(kVectorAlignment) float t_near[BvhNode::kWidth];
    const unsigned met = group_.boxes_met_by(i, node, t_near);
    if (kQuery == Query::kAny) {
      enter_any(node, i, met);
    } else {
      enter_closest(node, i, met, t_near);
    }
    return true;
  }

  // As in RayTraversal::find_any, the ray advances before the packets that it has reached are tested.
  void enter_any(const BvhNode& node, std::size_t i, unsigned met) {
    const unsigned packet_lanes = node.packet_lanes();
    for (unsigned lanes = met & packet_lanes; lanes != 0; lanes &= lanes - 1)
      enqueue_leaf(i, node.children[static_cast<std::size_t>(std::countr_zero(lanes))].index());
    for (unsigned lanes = met & ~packet_lanes; lanes != 0; lanes &= lanes - 1)
      stacks_.push(i, {0, node.children[static_cast<std::size_t>(std::countr_zero(lanes))]});
    go_on(i);
  }

  // The nearest child is next. One or two children are common.
  void enter_closest(const BvhNode& node, std::size_t i, unsigned met, const float* t_near) {
    if (met == 0) return go_on(i);
    const auto first = static_cast<std::size_t>(std::countr_zero(met));
    const unsigned others = met & (met - 1);
    if (others == 0) return schedule_node(i, node.children[first]);
    if ((others & (others - 1)) == 0) {
      const auto second = static_cast<std::size_t>(std::countr_zero(others));
      const StackEntry a(t_near[first], node.children[first]), b(t_near[second], node.children[second]);
      stacks_.push(i, std::max(a, b));
      return schedule_node(i, std::min(a, b).child());
    }
    const std::size_t base = stacks_.size(i);
    for (unsigned lanes = met; lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
      stacks_.push_sorted(i, base, {t_near[lane], node.children[lane]});
    }
    go_on(i);
  }

  // Enough packets that their tests do not wait for each other. Shadow rays test at once, because a hit
  // saves the remaining nodes.
  static constexpr std::size_t kManyPackets = kQuery == Query::kAny ? 1 : 16;

  const RayGroup<AnyRay>& group_;
  const BvhNode* const nodes_;
  const BvhPacket* const packets_;
  RaySet diverged_ = 0;  // rays that have kept entries
  RaySet at_node_ = 0;   // rays that visit node next_[i] in the next round
  RayStacks stacks_;
  std::array<std::uint32_t, kGroupSize> next_;
  std::size_t reached_count_ = 0;
  // Room for one packet of each ray; for kAny, for all packets of one node of each ray, since these are
  // tested before the next nodes.
  std::array<Reached, (kQuery == Query::kAny ? BvhNode::kWidth : 1) * kGroupSize> reached_;
};

}  // namespace tessera::core
