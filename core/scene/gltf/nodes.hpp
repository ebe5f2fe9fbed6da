// SPDX-License-Identifier: Apache-2.0
// The nodes of a glTF file as a forest, placed as they are at rest, or where an animation has them at a time.
// A node that has two parents keeps the first, and cycles are cut, with warnings.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "core/math/transform.hpp"
#include "core/scene/gltf/accessor.hpp"
#include "core/scene/gltf/document.hpp"
#include "core/scene/gltf/selection.hpp"

namespace tessera::core::gltf {

struct Node {
  Value value;
  std::vector<std::uint32_t> children;
  std::optional<std::uint32_t> parent{};
  // One for each of Selection::moments(), the first of which is the time that is shown without shutter.
  std::vector<Transform> to_world;
  std::vector<std::vector<float>> weights;  // of morph targets, empty where this node has none of its own

  bool moves() const { return !are_equal(to_world); }
  bool changes_weights() const { return !are_equal(weights); }

 private:
  template <typename T>
  static bool are_equal(const std::vector<T>& all) {
    return std::ranges::adjacent_find(all, std::ranges::not_equal_to()) == all.end();
  }
};

// All nodes of the file; index i is nodes[i].
std::vector<Node> read_nodes(const Document& document, Accessors& accessors, const Selection& selection);

// The visible nodes of the chosen scene (KHR_node_visibility), in the order of a walk from its first node
// down, each once. If the file has no scene, all nodes.
std::vector<std::uint32_t> nodes_of_scene(const Document& document, const std::vector<Node>& nodes,
                                          const Selection& selection);

// The map of a translation, a rotation (a quaternion x, y, z, w of any length) and a scale.
Transform placed(Vec3 translation, const std::vector<float>& rotation, Vec3 scale);

// "nodes[3] (Helmet)"
std::string name_of(const Value& value);

}  // namespace tessera::core::gltf
