// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/nodes.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "core/math/quaternion.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core::gltf {
namespace {

// The parameters of a node, as the file gives them or as an animation replaces them.
struct NodePose {
  Vec3 translation{0, 0, 0}, scale{1, 1, 1};
  std::vector<float> rotation{0, 0, 0, 1};
  std::vector<float> matrix;  // of 16 numbers, or empty
  std::vector<float> weights;
};

std::vector<float> numbers_of(const Value& list) {
  std::vector<float> numbers;
  for (std::size_t i = 0; i < list.size(); ++i) numbers.push_back(list.at(i).number());
  return numbers;
}

NodePose read_pose(const Value& node) {
  NodePose pose;
  pose.translation = node.vector_or("translation", pose.translation);
  pose.scale = node.vector_or("scale", pose.scale);
  if (auto rotation = node.numbers("rotation", 4); !rotation.empty()) pose.rotation = std::move(rotation);
  pose.matrix = node.numbers("matrix", 16);
  pose.weights = numbers_of(node["weights"]);
  return pose;
}

// Replaces parameters of nodes by those of the first animation at its beginning: its first keyframes.
class FirstKeyframes {
 public:
  FirstKeyframes(const Document& document, Accessors& accessors, std::vector<NodePose>& poses)
      : document_(document), accessors_(accessors), poses_(poses) {}

  void apply(const Value& animation) {
    const Value channels = animation["channels"];
    for (std::size_t i = 0; i < channels.size(); ++i) apply(animation, channels.at(i));
  }

 private:
  void apply(const Value& animation, const Value& channel);
  NodePose& pose_of(const Value& node) {
    document_.element("nodes", node);
    return poses_[static_cast<std::size_t>(node.whole())];
  }
  void apply_weights(const Value& sampler, NodePose& pose);

  const Document& document_;
  Accessors& accessors_;
  std::vector<NodePose>& poses_;
};

void FirstKeyframes::apply(const Value& animation, const Value& channel) {
  const Value target = channel["target"], sampler_index = channel["sampler"];
  const std::string path = target.text("path");
  if (!target["node"].exists() || !sampler_index.exists())
    return document_.warn(target, "animation target", "an animation of something else than nodes is ignored");
  NodePose& pose = pose_of(target["node"]);
  const Value samplers = animation["samplers"];
  if (sampler_index.whole() >= samplers.size()) sampler_index.refuse("there is no such sampler");
  const Value sampler = samplers.at(static_cast<std::size_t>(sampler_index.whole()));
  if (path == "weights") return apply_weights(sampler, pose);
  if (path != "translation" && path != "rotation" && path != "scale")
    return document_.warn(target, "animation path",
                          fmt::format("the animation of {} is ignored", in_quotes(path)));
  const Accessor values = accessors_.read(sampler["output"], path == "rotation" ? 4 : 3);
  // A cubic spline has a tangent before each value.
  const std::size_t first = sampler.text("interpolation") == "CUBICSPLINE" ? 1 : 0;
  if (values.count() <= first) return;
  pose.matrix.clear();
  if (path == "translation") pose.translation = values.vec3(first);
  if (path == "scale") pose.scale = values.vec3(first);
  if (path == "rotation")
    for (std::size_t c = 0; c < 4; ++c) pose.rotation[c] = values.number(first, c);
}

void FirstKeyframes::apply_weights(const Value& sampler, NodePose& pose) {
  const Accessor times = accessors_.read(sampler["input"], 1), values = accessors_.read(sampler["output"], 1);
  const bool is_spline = sampler.text("interpolation") == "CUBICSPLINE";
  if (times.count() == 0) return;
  const std::size_t targets = values.count() / times.count() / (is_spline ? 3 : 1);
  pose.weights.clear();
  for (std::size_t i = 0; i < targets; ++i)
    pose.weights.push_back(values.number(is_spline ? targets + i : i, 0));
}

Transform local_transform(const NodePose& pose) {
  const std::vector<float>& m = pose.matrix;
  if (m.empty()) return placed(pose.translation, pose.rotation, pose.scale);
  return {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}, {m[12], m[13], m[14]}};
}

void connect(const Document& document, std::vector<Node>& nodes) {
  for (Node& node : nodes) {
    const Value children = node.value["children"];
    for (std::size_t i = 0; i < children.size(); ++i) {
      const Value child = children.at(i);
      document.element("nodes", child);
      Node& other = nodes[static_cast<std::size_t>(child.whole())];
      if (other.has_parent)
        child.refuse(fmt::format("nodes[{}] has two parents; nodes must form trees", child.whole()));
      other.has_parent = true;
      node.children.push_back(static_cast<std::uint32_t>(child.whole()));
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
    if (!nodes[i].has_parent) roots.push_back(i);
  return roots;
}

// Every node has at most one parent by now, so that those that no root reaches form cycles.
void place(std::vector<Node>& nodes, const std::vector<NodePose>& poses) {
  std::vector<bool> reached(nodes.size());
  const auto roots = roots_of(nodes);
  for (const std::uint32_t root : roots) nodes[root].to_world = local_transform(poses[root]);
  walk(nodes, roots, [&](std::uint32_t at) {
    reached[at] = true;
    for (const std::uint32_t child : nodes[at].children)
      nodes[child].to_world = compose(nodes[at].to_world, local_transform(poses[child]));
    return true;
  });
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (!reached[i]) nodes[i].value.refuse("is its own ancestor; nodes must form trees");
}

bool is_visible(const Value& node) {
  const Value extension = node.extension("KHR_node_visibility");
  return !extension["visible"].exists() || extension.is_true("visible");
}

void apply_animation(const Document& document, Accessors& accessors, std::vector<NodePose>& poses) {
  const Value animations = document.root()["animations"];
  if (animations.size() == 0) return;
  FirstKeyframes(document, accessors, poses).apply(animations.at(0));
  document.warn(animations, "animation",
                fmt::format("the scene is rendered as it is at the beginning of the first of {} animations",
                            animations.size()));
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

std::vector<Node> read_nodes(const Document& document, Accessors& accessors) {
  const Value list = document.root()["nodes"];
  std::vector<Node> nodes(list.size());
  std::vector<NodePose> poses;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    nodes[i].value = list.at(i);
    poses.push_back(read_pose(nodes[i].value));
  }
  connect(document, nodes);
  apply_animation(document, accessors, poses);
  place(nodes, poses);
  for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i].weights = std::move(poses[i].weights);
  return nodes;
}

std::vector<std::uint32_t> nodes_of_scene(const Document& document, const std::vector<Node>& nodes) {
  const Value scenes = document.root()["scenes"], chosen = document.root()["scene"];
  std::vector<std::uint32_t> roots = roots_of(nodes);
  if (scenes.size() > 0) {
    const Value scene = chosen.exists() ? document.element("scenes", chosen) : scenes.at(0);
    if (scenes.size() > 1)
      document.warn(scenes, "scenes",
                    fmt::format("of {} scenes, only {} is rendered", scenes.size(), name_of(scene)));
    roots.clear();
    std::vector<bool> is_root(nodes.size());
    const Value list = scene["nodes"];
    for (std::size_t i = 0; i < list.size(); ++i) {
      document.element("nodes", list.at(i));
      const auto root = static_cast<std::uint32_t>(list.at(i).whole());
      if (nodes[root].has_parent)
        list.at(i).refuse(fmt::format("nodes[{}] is the child of another node", root));
      if (is_root[root]) list.at(i).refuse(fmt::format("nodes[{}] is there twice", root));
      is_root[root] = true;
      roots.push_back(root);
    }
  }
  std::vector<std::uint32_t> order;
  walk(nodes, roots, [&](std::uint32_t at) {
    const bool visible = is_visible(nodes[at].value);
    if (visible) order.push_back(at);
    return visible;
  });
  return order;
}

std::string name_of(const Value& value) {
  const std::string name = value.text("name");
  return name.empty() ? value.path() : fmt::format("{} ({})", value.path(), printable(name));
}

}  // namespace tessera::core::gltf
