// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mitsuba/graph_passes.hpp"

#include <algorithm>
#include <optional>
#include <vector>

namespace tessera::core::mitsuba {
namespace {

// The longest chain below the node; nullopt below a node that is too deep. A cycle is deeper than any limit.
std::optional<int> height_of(const SceneGraph& graph, NodeId id, std::vector<int>& heights, int depth,
                             const Node*& deep) {
  const Node& node = graph.nodes[id];
  if (heights[id] < 0 && depth <= kMaxNesting) {
    int height = 0;
    for (const Property& property : node.properties) {
      const auto* child = std::get_if<Child>(&property.value);
      if (child == nullptr) continue;
      const auto below = height_of(graph, child->node, heights, depth + 1, deep);
      if (!below) return std::nullopt;
      height = std::max(height, *below + 1);
    }
    heights[id] = height;
  }
  if (heights[id] >= 0 && depth + heights[id] <= kMaxNesting) return heights[id];
  deep = &node;
  return std::nullopt;
}

}  // namespace

const Node* too_deep(const SceneGraph& graph) {
  std::vector<int> heights(graph.nodes.size(), -1);
  const Node* deep = nullptr;
  height_of(graph, 0, heights, 0, deep);
  return deep;
}

void upgrade_node(Node& node) {
  Transform to_uv;
  bool has_to_uv = false;
  for (Property& property : node.properties) {
    if (node.type.ends_with("diffuse") && property.name == "diffuse_reflectance")
      property.name = "reflectance";
    const bool is_scale = property.name == "uscale" || property.name == "vscale";
    const auto* number = std::get_if<double>(&property.value);
    if (number == nullptr || (!is_scale && property.name != "uoffset" && property.name != "voffset"))
      continue;
    const int axis = property.name.front() == 'u' ? 0 : 1;
    if (is_scale)
      (axis == 0 ? to_uv.x_axis : to_uv.y_axis)[axis] = static_cast<float>(*number);
    else
      to_uv.origin[axis] = static_cast<float>(*number);
    property.used = has_to_uv = true;
  }
  if (!has_to_uv) return;
  to_uv.origin = to_uv.direction(to_uv.origin);  // the offset comes first
  node.properties.push_back({"to_uv", node.where, to_uv, false});
}

}  // namespace tessera::core::mitsuba
