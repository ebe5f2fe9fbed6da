// SPDX-License-Identifier: Apache-2.0
// The lights of a tree that meet a double cone, to choose one of them by the light that it sends to the apex
// from within the cone, or through the apex. Where there are many, the tree is only partly searched, and the
// rest of the way down is chosen by chance. Cheap to make, for one cone; the same for the same cone.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/geometry/double_cone.hpp"
#include "core/lights/light_tree.hpp"

namespace tessera::core::lights {

class LightsInCone {
 public:
  // Keeps a reference to the tree.
  LightsInCone(const LightTree& tree, const DoubleCone& cone);

  bool empty() const { return !(sum_ > 0); }
  // At the apex, of all the lights, approximately and rather too large.
  double solid_angle() const { return solid_angle_; }

  // u is in [0, 1], with more bits than a float has. May return kNoLight.
  LightTree::Choice sample(double u) const;
  // The probability with which sample() chooses the light.
  float pmf(std::uint32_t light) const;

 private:
  static constexpr std::size_t kWidth = LightTree::kWidth;
  // Parts of the tree that are told apart.
  static constexpr std::size_t kMaxParts = 64;

  struct Part {
    std::uint32_t place = 0;  // kWidth * node + lane
    float weight = 0;         // 0 if its children are parts instead
    float solid_angle = 0;
  };
  // The children of a node.
  struct Children {
    alignas(32) LightTree::Lanes weights;  // 0 for those outside the cone
    alignas(32) LightTree::Lanes solid_angles;
  };
  Children children(std::size_t node) const;
  void add_children(std::size_t node);
  std::int32_t child_at(std::uint32_t place) const;

  const LightTree& tree_;
  const DoubleCone cone_;
  std::array<Part, kMaxParts> parts_;
  std::size_t count_ = 0;
  double sum_ = 0, solid_angle_ = 0;  // sums over parts
};

}  // namespace tessera::core::lights
