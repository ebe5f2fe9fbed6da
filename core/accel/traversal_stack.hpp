// SPDX-License-Identifier: Apache-2.0
// The stack of nodes and packets that are still to be visited, and the order in which they are. All
// traversals share both.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/accel/bvh_layout.hpp"

namespace tessera::core::accel {

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
inline constexpr std::size_t kMaxStackSize = 1 + (BvhNode::kWidth - 1) * (kMaxTreeDepth + 1);

// Entries compare by distance. Must be cleared before its first use; creating it costs nothing.
template <typename Entry, std::size_t kCapacity>
class TraversalStack {
 public:
  void clear() { size_ = 0; }
  bool empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  // Whether the children of one more node fit.
  bool has_room() const { return size_ <= kCapacity - BvhNode::kWidth; }

  void push(const Entry& entry) { entries_[size_++] = entry; }
  // Inserts among the entries from `base` on, so that the nearest of these is on top.
  void push_sorted(std::size_t base, const Entry& entry) {
    std::size_t slot = size_++;
    for (; slot > base && entries_[slot - 1] < entry; --slot) entries_[slot] = entries_[slot - 1];
    entries_[slot] = entry;
  }

  const Entry& pop() { return entries_[--size_]; }
  // Pops the next child that begins before `limit`; returns false if there is none.
  bool pop(float limit, BvhChild& child) {
    while (size_ > 0) {
      const Entry top = entries_[--size_];
      child = top.child();
      if (top.t_near() <= limit) return true;
    }
    return false;
  }

 private:
  std::size_t size_;
  std::array<Entry, kCapacity> entries_;
};

// The order for closest hits: stores the nearest child of those that a ray has `met` in `next`, or else an
// entry from the stack, and pushes the others. Returns false if there is none. One or two children are
// common.
template <std::size_t kCapacity>
inline bool next_nearest(TraversalStack<StackEntry, kCapacity>& stack, const BvhNode& node, unsigned met,
                         const float* t_near, float limit, BvhChild& next) {
  if (met == 0) return stack.pop(limit, next);
  const auto first = static_cast<std::size_t>(std::countr_zero(met));
  next = node.children[first];
  const unsigned others = met & (met - 1);
  if (others == 0) return true;
  if ((others & (others - 1)) == 0) {
    const auto second = static_cast<std::size_t>(std::countr_zero(others));
    const StackEntry a(t_near[first], next), b(t_near[second], node.children[second]);
    stack.push(std::max(a, b));
    next = std::min(a, b).child();
    return true;
  }
  const std::size_t base = stack.size();
  for_each_lane(met, [&](std::size_t lane) { stack.push_sorted(base, {t_near[lane], node.children[lane]}); });
  return stack.pop(limit, next);
}

// The order for any hit: pushes the nodes that a ray has `met`, unsorted, since a ray without a hit visits
// them all. Returns the lanes of the packets met, which are tested at once: this overlaps their latency with
// that of the next node.
template <std::size_t kCapacity>
inline unsigned push_nodes(TraversalStack<StackEntry, kCapacity>& stack, const BvhNode& node, unsigned met) {
  const unsigned packet_lanes = node.packet_lanes();
  for_each_lane(met & ~packet_lanes, [&](std::size_t lane) { stack.push({0, node.children[lane]}); });
  return met & packet_lanes;
}

}  // namespace tessera::core::accel
