// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/nodes.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <utility>

#include "core/math/quaternion.hpp"
#include "core/scene/gltf/animation.hpp"
#include "core/scene/gltf/node_mistakes.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core::gltf {
namespace {

NodePose read_pose(const Document& document, const Value& node) {
  NodePose pose;
  pose.translation = node.vector_or("translation", pose.translation);
  pose.scale = node.vector_or("scale", pose.scale);
  if (auto rotation = node.numbers("rotation", 4); !rotation.empty()) pose.rotation = std::move(rotation);
  pose.matrix = node.numbers("matrix", 16);
  pose.weights = node.numbers("weights");
  tell_second_placement(document, node);
  tell_odd_rotation(document, node["rotation"], pose.rotation);
  return pose;
}

Transform local_transform(const NodePose& pose) {
  const std::vector<float>& m = pose.matrix;
  if (m.empty()) return placed(pose.translation, pose.rotation, pose.scale);
  return {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[12], m[13], m[14]}};
}

void connect(const Document& document, std::vector<Node>& nodes) {
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    const Value children = nodes[i].value["children"];
    for (std::size_t k = 0; k < children.size(); ++k) {
      const Value child = children.at(k);
      document.try_to(child, "child", "it is left out", [&] {
        Document::element(document.root()["nodes"], child);
        const auto number = static_cast<std::uint32_t>(child.whole());
        if (nodes[number].parent)
          child.refuse(fmt::format("nodes[{}] has two parents; nodes must form trees", number));
        nodes[number].parent = i;
        nodes[i].children.push_back(number);
      });
    }
  }
}

// Calls visit(node) for `roots` and all nodes below those for which it returns true, parents first, and
// without recursion: files may nest nodes as deep as they like. Needs a forest.
template <typename Visit>
void walk(const std::vector<Node>& nodes, const std::vector<std::uint32_t>& roots, const Visit& visit) {
  std::vector<std::uint32_t> open(roots.rbegin(), roots.rend());
  while (!open.empty()) {
    const std::uint32_t at = open.back();
    open.pop_back();
    if (!visit(at)) continue;
    const auto& children = nodes[at].children;
    open.insert(open.end(), children.rbegin(), children.rend());
  }
}

std::vector<std::uint32_t> roots_of(const std::vector<Node>& nodes) {
  std::vector<std::uint32_t> roots;
  for (std::uint32_t i = 0; i < nodes.size(); ++i)
    if (!nodes[i].parent) roots.push_back(i);
  return roots;
}

// A node of the cycle that the parents of `node` lead to.
std::uint32_t node_of_cycle(const std::vector<Node>& nodes, std::uint32_t node, std::vector<bool>& passed) {
  while (!passed[node]) {
    passed[node] = true;
    node = *nodes[node].parent;
  }
  return node;
}

// Every node has at most one parent, so that those that no root reaches are in a cycle or below one.
void cut_cycles(const Document& document, std::vector<Node>& nodes) {
  std::vector<bool> reached(nodes.size()), passed(nodes.size());
  const auto reach = [&](const std::vector<std::uint32_t>& roots) {
    walk(nodes, roots, [&](std::uint32_t at) {
      reached[at] = true;
      return true;
    });
  };
  reach(roots_of(nodes));
  for (std::uint32_t i = 0; i < nodes.size(); ++i) {
    if (reached[i]) continue;
    const std::uint32_t root = node_of_cycle(nodes, i, passed);
    document.warn(nodes[root].value, "cycle", "is its own ancestor; it is no longer the child of a node");
    std::erase(nodes[*nodes[root].parent].children, root);
    nodes[root].parent.reset();
    reach({root});
  }
}

// At one more moment.
void place(std::vector<Node>& nodes, const std::vector<NodePose>& poses) {
  const auto roots = roots_of(nodes);
  for (const std::uint32_t root : roots) nodes[root].to_world.push_back(local_transform(poses[root]));
  walk(nodes, roots, [&](std::uint32_t at) {
    for (const std::uint32_t child : nodes[at].children)
      nodes[child].to_world.push_back(compose(nodes[at].to_world.back(), local_transform(poses[child])));
    return true;
  });
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    auto& weights = nodes[i].weights.emplace_back();
    if (nodes[i].value["mesh"].exists()) weights = poses[i].weights;
  }
}

bool is_visible(const Value& node) {
  return node.extension("KHR_node_visibility").is_true("visible", true);
}

// What was not chosen of the animations.
void tell_choice(const Document& document, const Value& animations, const Selection& selection) {
  const std::size_t all = animations.size(), chosen = selection.animations.size();
  if (chosen == 0) return;
  const std::string played =
      chosen < all
          ? fmt::format("{} of {} animations",
                        selection.animations[0].path() == animations.at(0).path() ? "the first" : "one", all)
          : (all == 1 ? "its animation" : fmt::format("all {} animations", all));
  if (!selection.seconds)
    document.warn(animations, "animation",
                  fmt::format("the scene is rendered as it is at the beginning of {}; a time can be chosen "
                              "(--animation-time), {}or none (--animation none)",
                              played, chosen < all ? "another one or all (--animation all), " : ""));
  else if (chosen < all && !selection.names_animations)
    document.warn(
        animations, "animation",
        fmt::format("only {} is played; another one can be chosen, or all (--animation all)", played));
}

// Those that were chosen.
std::vector<NodeAnimation> read_animations(const Document& document, Accessors& accessors,
                                           const Selection& selection) {
  const Value animations = document.root()["animations"];
  for (std::size_t i = 0; i < animations.size(); ++i)
    document.builder().scene().contents.animations.push_back(
        {printable(animations.at(i).text("name")), length_of(document, animations.at(i))});
  tell_choice(document, animations, selection);
  std::vector<NodeAnimation> chosen;
  for (const Value& animation : selection.animations) chosen.emplace_back(document, accessors, animation);
  return chosen;
}

Value default_scene(const Document& document) {
  const Value index = document.root()["scene"], scenes = document.root()["scenes"];
  const Value scene =
      index.exists() ? document.element_or_none(scenes, index, "the first scene is rendered") : Value();
  return scene.exists() ? scene : scenes.at(0);
}

// The nodes that a scene names.
std::vector<std::uint32_t> roots_of_scene(const Document& document, const std::vector<Node>& nodes,
                                          const Value& scene) {
  std::vector<std::uint32_t> roots;
  std::vector<bool> is_root(nodes.size());
  const Value list = scene["nodes"];
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!document.element_or_none("nodes", list.at(i), "it is left out").exists()) continue;
    const auto root = static_cast<std::uint32_t>(list.at(i).whole());
    if (nodes[root].parent || is_root[root])
      document.warn(list.at(i), "node of a scene",
                    fmt::format("nodes[{}] is {}; it is shown once", root,
                                is_root[root] ? "there twice" : "the child of another node"));
    is_root[root] = true;
    roots.push_back(root);
  }
  return roots;
}

}  // namespace

Transform placed(Vec3 translation, const std::vector<float>& rotation, Vec3 scale) {
  Quaternion q{rotation[3], rotation[0], rotation[1], rotation[2]};
  const float norm = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  if (norm > 0 && std::isfinite(norm))
    q = {q.w / norm, q.x / norm, q.y / norm, q.z / norm};
  else
    q = {};
  Transform map = core::rotation(q);
  map.x_axis = map.x_axis * scale.x;
  map.y_axis = map.y_axis * scale.y;
  map.z_axis = map.z_axis * scale.z;
  map.origin = translation;
  return map;
}

std::vector<Node> read_nodes(const Document& document, Accessors& accessors, const Selection& selection) {
  const Value list = document.root()["nodes"];
  std::vector<Node> nodes(list.size());
  std::vector<NodePose> at_rest;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    nodes[i].value = list.at(i);
    at_rest.push_back(read_pose(document, nodes[i].value));
  }
  connect(document, nodes);
  cut_cycles(document, nodes);
  const auto animations = read_animations(document, accessors, selection);
  for (const float moment : selection.moments()) {
    std::vector<NodePose> poses = at_rest;
    for (const NodeAnimation& animation : animations)
      animation.apply(selection.seconds.value_or(0) + moment, poses);
    place(nodes, poses);
  }
  return nodes;
}

std::vector<std::uint32_t> nodes_of_scene(const Document& document, const std::vector<Node>& nodes,
                                          const Selection& selection) {
  const Value scenes = document.root()["scenes"];
  std::vector<std::uint32_t> roots = roots_of(nodes);
  if (scenes.size() > 0) {
    const Value scene = selection.scene ? *selection.scene : default_scene(document);
    if (scenes.size() > 1 && !selection.scene)
      document.warn(scenes, "scenes",
                    fmt::format("of {} scenes, only {} is rendered; another one can be chosen (--scene)",
                                scenes.size(), name_of(scene)));
    roots = roots_of_scene(document, nodes, scene);
  }
  std::vector<std::uint32_t> order;
  std::vector<bool> shown(nodes.size());
  walk(nodes, roots, [&](std::uint32_t at) {
    if (shown[at] || !is_visible(nodes[at].value)) return false;
    shown[at] = true;
    order.push_back(at);
    return true;
  });
  return order;
}

std::string name_of(const Value& value) {
  const std::string name = value.text("name");
  return name.empty() ? value.path() : fmt::format("{} ({})", value.path(), printable(name));
}

}  // namespace tessera::core::gltf
