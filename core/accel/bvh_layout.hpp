// SPDX-License-Identifier: Apache-2.0
// The memory layout of a Bvh: nodes of sixteen boxes and packets of four primitives, laid out for SIMD
// tests.
#pragma once

#include <array>
#include <cstdint>

#include "core/math/simd_integer.hpp"

namespace tessera::core {

// A reference to a node or a packet, by its index in the Bvh's arrays.
class BvhChild {
 public:
  BvhChild() = default;
  static constexpr BvhChild node(std::uint32_t index) { return BvhChild(index); }
  static constexpr BvhChild packet(std::uint32_t index) { return BvhChild(index | kPacketBit); }

  // Bit i is set if child i of these eight is a packet.
  static unsigned packets_among(const BvhChild* eight) {
    static_assert(sizeof(BvhChild) == sizeof(bits_) && kPacketBit == 1u << 31);
    return highest_bits(U32x8::load(&eight->bits_));
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
  return BvhChild::packets_among(children.data()) | BvhChild::packets_among(children.data() + 8) << 8;
}

// The primitives of a leaf, one in each lane; triangles include a copy of their corners, unless they move.
// Parts of curves have a line and a radius that bound them (CurveTube): the start and the end in the first
// two corners, the radius in the first coordinate of the third, and the part's source (tube_test.hpp) in the
// others. Unused lanes are in no mask.
struct alignas(64) BvhPacket {
  static constexpr int kWidth = 4;

  float corners[3][3][kWidth] = {};  // [corner][axis][lane]
  std::uint32_t primitives[kWidth] = {};
  std::uint32_t triangle_lanes = 0;  // bit i for lane i
  std::uint32_t sphere_lanes = 0;
  std::uint32_t instance_lanes = 0;
  std::uint32_t quadric_lanes = 0;  // disks and cylinders
  std::uint32_t curve_lanes = 0;
  std::uint32_t moving_lanes = 0;  // triangles that deform while the shutter is open
  std::uint32_t unused[2] = {};    // pads to the cache line, so that equal packets have equal bytes

  bool operator==(const BvhPacket&) const = default;
};

}  // namespace tessera::core
