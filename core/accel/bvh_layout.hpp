// SPDX-License-Identifier: Apache-2.0
// The memory layout of a Bvh: nodes of sixteen boxes and packets of four primitives, laid out for SIMD
// tests.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/accel/hit_opacity.hpp"
#include "core/geometry/geometry_kind.hpp"
#include "core/math/simd.hpp"
#include "core/math/simd_integer.hpp"

namespace tessera::core::accel {

// No leaf of the binary tree that a Bvh is made from is deeper.
inline constexpr int kMaxTreeDepth = 72;

// Calls what(lane) for each lane of `lanes`.
template <typename What>
inline void for_each_lane(unsigned lanes, const What& what) {
  for (; lanes != 0; lanes &= lanes - 1) what(static_cast<std::size_t>(std::countr_zero(lanes)));
}

// A reference to a node or a packet, by its index in the Bvh's arrays.
class BvhChild {
 public:
  BvhChild() = default;
  static constexpr BvhChild node(std::uint32_t index) { return BvhChild(index); }
  static constexpr BvhChild packet(std::uint32_t index) { return BvhChild(index | kPacketBit); }

  // Bit i is set if child i of a vector of them is a packet.
  static unsigned packets_among(const BvhChild* children) {
    static_assert(sizeof(BvhChild) == sizeof(bits_) && kPacketBit == 1u << 31);
    return highest_bits(U32xN::load(&children->bits_));
  }

  bool is_packet() const { return (bits_ & kPacketBit) != 0; }
  std::uint32_t index() const { return bits_ & ~kPacketBit; }
  bool operator==(const BvhChild&) const = default;

 private:
  static constexpr std::uint32_t kPacketBit = 0x80000000u;
  constexpr explicit BvhChild(std::uint32_t bits) : bits_(bits) {}
  std::uint32_t bits_;  // uninitialised, so that creating a stack of these costs nothing
};

// An unused lane has an empty box, which no ray enters, and refers to packet 0, which is safe to test.
struct alignas(64) BvhNode {
  static constexpr int kWidth = 16;
  enum Side { kLower, kUpper };

  float bounds[6][kWidth];  // [3 * side + axis][lane]
  std::array<BvhChild, kWidth> children;

  BvhNode();
  // Bit i is set if the child in lane i is a packet or unused.
  unsigned packet_lanes() const;
  bool operator==(const BvhNode&) const = default;
};

inline unsigned BvhNode::packet_lanes() const {
  static_assert(kWidth == 2 * kLaneCount);
  return BvhChild::packets_among(children.data()) | BvhChild::packets_among(children.data() + kLaneCount)
                                                        << kLaneCount;
}

// The primitives of a leaf, which are of one kind, one in each lane. Triangles that do not move include a
// copy of their corners. Parts of curves have a line and a radius that bound them (CurveTube): the start and
// the end in the first two corners, the radius in the first coordinate of the third, and the part's source
// (tube_test.hpp) in the others.
struct alignas(64) BvhPacket {
  static constexpr int kWidth = 4;

  float corners[3][3][kWidth] = {};  // [corner][axis][lane]
  std::uint32_t primitives[kWidth] = {};
  GeometryKind kind = GeometryKind::kTriangle;
  std::uint32_t lanes = 0;                             // bit i for lane i, if it is used
  MaterialOpacity opacity = MaterialOpacity::kOpaque;  // the greatest of the primitives
  std::uint32_t unused[5] = {};  // pads to the cache line, so that equal packets have equal bytes

  bool operator==(const BvhPacket&) const = default;
};

}  // namespace tessera::core::accel
