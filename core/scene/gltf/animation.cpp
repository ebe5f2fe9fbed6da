// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/animation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include "core/scene/gltf/animated_values.hpp"
#include "core/scene/gltf/keyframe_sampler.hpp"
#include "core/scene/gltf/node_mistakes.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core::gltf {
namespace {

// More than any mesh has morph targets; many nodes can refer to one accessor of millions of numbers.
constexpr std::size_t kMaxWeights = 4096;

// What glTF forbids of an animation of a node's `path`. Looks at `rotations` keyframes at most, and takes
// their number off: many channels can refer to one accessor.
void tell_mistakes(const Document& document, const Value& node, std::string_view path,
                   const KeyframeSampler& sampler, const Value& output, std::size_t& rotations) {
  if (path == "weights") {
    const Value meshes = document.root()["meshes"];
    const auto mesh = node["mesh"].as_whole();
    if (mesh && *mesh < meshes.size()) tell_odd_weights(document, output, sampler.width(), meshes.at(*mesh));
    return;
  }
  if (node["matrix"].exists())
    document.warn(node, "animated matrix",
                  "is animated and has a matrix; its translation, rotation and scale replace the matrix");
  if (path != "rotation") return;
  for (std::size_t i = 0; i < sampler.keyframes() && rotations > 0; ++i, --rotations)
    tell_odd_rotation(document, output, sampler.value_of(i));
}

}  // namespace

// A parameter of a node.
struct NodeAnimation::Channel {
  std::size_t node;
  std::string path;
  KeyframeSampler sampler;

  bool is_rotation() const { return path == "rotation"; }
  void apply(float seconds, NodePose& pose) const;
};

void NodeAnimation::Channel::apply(float seconds, NodePose& pose) const {
  const std::vector<float> values = sampler.at(seconds, is_rotation());
  if (path == "weights") {
    pose.weights.assign(values.begin(),
                        values.begin() + static_cast<std::ptrdiff_t>(std::min(values.size(), kMaxWeights)));
    return;
  }
  pose.matrix.clear();
  if (is_rotation()) pose.rotation = values;
  if (path == "translation") pose.translation = {values[0], values[1], values[2]};
  if (path == "scale") pose.scale = {values[0], values[1], values[2]};
}

NodeAnimation::NodeAnimation(const Document& document, Accessors& accessors, const Value& animation) {
  const Value channels = animation["channels"];
  for (std::size_t i = 0; i < channels.size(); ++i)
    document.try_to(channels.at(i), "animation channel", "it is ignored",
                    [&] { add_channel(document, accessors, animation, channels.at(i)); });
}

void NodeAnimation::add_channel(const Document& document, Accessors& accessors, const Value& animation,
                                const Value& channel) {
  const Value target = channel["target"], node = target["node"];
  const std::string path = target.text("path");
  if (!pointer_of(target).empty()) return;  // apply_pointers() has read it
  if (!node.exists() || !channel["sampler"].exists())
    return document.warn(target, "animation target", "an animation of something else than nodes is ignored");
  if (path != "weights" && path != "translation" && path != "rotation" && path != "scale")
    return document.warn(target, "animation path",
                         fmt::format("the animation of {} is ignored", in_quotes(path)));
  const Value animated = document.element("nodes", node);
  const Value sampler_value = Document::element(animation["samplers"], channel["sampler"]);
  const bool is_weights = path == "weights";
  KeyframeSampler sampler(sampler_value, accessors, is_weights ? 1 : path == "rotation" ? 4 : 3);
  if (is_weights) sampler.split_weights();
  if (sampler.empty())
    return document.warn(sampler_value, "animation without keyframes", "has no keyframes; it is ignored");
  tell_mistakes(document, animated, path, sampler, sampler_value["output"], rotations_to_check_);
  channels_.push_back({static_cast<std::size_t>(node.whole()), path, std::move(sampler)});
}

NodeAnimation::~NodeAnimation() = default;
NodeAnimation::NodeAnimation(NodeAnimation&&) noexcept = default;

void NodeAnimation::apply(float seconds, std::vector<NodePose>& poses) const {
  for (const Channel& channel : channels_) channel.apply(seconds, poses[channel.node]);
}

float length_of(const Document& document, const Value& animation) {
  const Value samplers = animation["samplers"], accessors = document.root()["accessors"];
  float seconds = 0;
  for (std::size_t i = 0; i < samplers.size(); ++i) {
    const Value input = samplers.at(i)["input"];
    document.try_to(input, "length of an animation", "its length counts as 0", [&] {
      const Value last = Document::element(accessors, input)["max"];
      if (last.size() > 0) seconds = std::max(seconds, last.at(0).number());
    });
  }
  return seconds;
}

}  // namespace tessera::core::gltf
