// SPDX-License-Identifier: Apache-2.0
// Animations of nodes at one time (Khronos Group 2021, glTF 2.0 specification, section 3.11 and appendix C).
// Not thread-safe; functions throw Refusals.
#pragma once

#include <cstddef>
#include <vector>

#include "core/math/vec3.hpp"
#include "core/scene/gltf/accessor.hpp"
#include "core/scene/gltf/document.hpp"

namespace tessera::core::gltf {

// The parameters of a node, as the file gives them or as an animation replaces them.
struct NodePose {
  Vec3 translation{0, 0, 0}, scale{1, 1, 1};
  std::vector<float> rotation{0, 0, 0, 1};  // a quaternion x, y, z, w of any length
  std::vector<float> matrix{};              // of 16 numbers, or empty
  std::vector<float> weights{};             // of morph targets
};

// What an animation does to nodes, read once for any number of times.
class NodeAnimation {
 public:
  NodeAnimation(const Document& document, Accessors& accessors, const Value& animation);
  ~NodeAnimation();
  NodeAnimation(NodeAnimation&&) noexcept;

  // Replaces parameters of nodes by those at a time. Before its first keyframe and after its last one, a
  // parameter is constant.
  void apply(float seconds, std::vector<NodePose>& poses) const;

 private:
  struct Channel;

  void add_channel(const Document& document, Accessors& accessors, const Value& animation,
                   const Value& channel);

  std::vector<Channel> channels_;
  std::size_t rotations_to_check_ = 1 << 20;  // keyframes
};

// The time of the last keyframe of all parameters, as the file says: "max" of their times.
float length_of(const Document& document, const Value& animation);

}  // namespace tessera::core::gltf
