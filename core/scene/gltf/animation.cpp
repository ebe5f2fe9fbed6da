// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/animation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "core/math/quaternion.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core::gltf {
namespace {

enum class Interpolation { kStep, kLinear, kCubicSpline };

Interpolation interpolation_of(const Value& sampler) {
  const std::string name = sampler.text("interpolation");
  if (name == "STEP") return Interpolation::kStep;
  return name == "CUBICSPLINE" ? Interpolation::kCubicSpline : Interpolation::kLinear;
}

// The keyframes around a time.
struct Between {
  std::size_t before = 0, after = 0;
  float part = 0;     // of the way from one to the other, from 0 to 1
  float seconds = 0;  // from one to the other
};

// Times increase. Of a damaged file, some keyframes are found.
Between locate(const Accessor& times, std::size_t count, float seconds) {
  std::size_t begin = 0, end = count;  // of those among which the first later one is
  while (begin < end) {
    const std::size_t middle = begin + (end - begin) / 2;
    if (times.number(middle, 0) > seconds)
      end = middle;
    else
      begin = middle + 1;
  }
  if (begin == 0) return {};
  if (begin == count) return {count - 1, count - 1, 0, 0};
  const float from = times.number(begin - 1, 0), span = times.number(begin, 0) - from;
  const float part = (seconds - from) / span;
  return {begin - 1, begin, part >= 0 && part <= 1 ? part : 0, span};
}

// A sampler of an animation. Each keyframe has `width` numbers, in elements of an accessor or one in each;
// with a cubic spline it has them three times: the tangent before it, the value, and the tangent behind it.
class KeyframeSampler {
 public:
  KeyframeSampler(const Value& sampler, Accessors& accessors, std::size_t components)
      : interpolation_(interpolation_of(sampler)),
        times_(accessors.read(sampler["input"], 1)),
        values_(accessors.read(sampler["output"], components)) {
    count_ = std::min(times_.count(), values_.count() / parts());
  }

  // Of weights of morph targets, which are numbers in a row.
  void split_weights() {
    if (times_.count() == 0) return;
    row_ = values_.count() / times_.count() / parts();
    count_ = row_ == 0 ? 0 : times_.count();
  }

  bool empty() const { return count_ == 0; }
  std::size_t row() const { return row_; }

  std::vector<float> at(float seconds, bool is_rotation) const {
    const Between between = locate(times_, count_, seconds);
    std::vector<float> before = numbers(between.before, kValue);
    if (between.part == 0 || interpolation_ == Interpolation::kStep) return before;
    const std::vector<float> after = numbers(between.after, kValue);
    if (interpolation_ == Interpolation::kCubicSpline) return spline(between, before, after);
    if (is_rotation) return turned(before, after, between.part);
    for (std::size_t c = 0; c < before.size(); ++c) before[c] += (after[c] - before[c]) * between.part;
    return before;
  }

 private:
  enum Part : std::size_t { kTangentBefore, kValue, kTangentBehind };

  std::size_t parts() const { return interpolation_ == Interpolation::kCubicSpline ? 3 : 1; }
  std::vector<float> numbers(std::size_t keyframe, Part part) const;
  std::vector<float> spline(const Between& between, const std::vector<float>& before,
                            const std::vector<float>& after) const;
  static std::vector<float> turned(const std::vector<float>& before, const std::vector<float>& after,
                                   float part);

  Interpolation interpolation_;
  Accessor times_, values_;
  std::size_t count_ = 0;  // of keyframes
  std::size_t row_ = 0;    // numbers of a keyframe that are elements of their own; 0: they are one element
};

std::vector<float> KeyframeSampler::numbers(std::size_t keyframe, Part part) const {
  const std::size_t at = parts() == 1 ? keyframe : 3 * keyframe + part;
  std::vector<float> found;
  for (std::size_t i = 0; i < row_; ++i) found.push_back(values_.number(at * row_ + i, 0));
  for (std::size_t c = 0; row_ == 0 && c < values_.components(); ++c) found.push_back(values_.number(at, c));
  return found;
}

// Hermite's polynomials (appendix C.5 of the specification).
std::vector<float> KeyframeSampler::spline(const Between& between, const std::vector<float>& before,
                                           const std::vector<float>& after) const {
  const std::vector<float> leaving = numbers(between.before, kTangentBehind),
                           arriving = numbers(between.after, kTangentBefore);
  const float t = between.part, t2 = t * t, t3 = t2 * t;
  std::vector<float> values;
  for (std::size_t c = 0; c < before.size(); ++c)
    values.push_back((2 * t3 - 3 * t2 + 1) * before[c] + between.seconds * (t3 - 2 * t2 + t) * leaving[c] +
                     (3 * t2 - 2 * t3) * after[c] + between.seconds * (t3 - t2) * arriving[c]);
  return values;
}

Quaternion unit_quaternion(const std::vector<float>& q) {
  const float norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(norm > 0) || !std::isfinite(norm)) return {};
  return {q[3] / norm, q[0] / norm, q[1] / norm, q[2] / norm};
}

std::vector<float> KeyframeSampler::turned(const std::vector<float>& before, const std::vector<float>& after,
                                           float part) {
  const Quaternion q = slerp(unit_quaternion(before), unit_quaternion(after), part);
  return {q.x, q.y, q.z, q.w};
}

// More than any mesh has morph targets; many nodes can refer to one accessor of millions of numbers.
constexpr std::size_t kMaxWeights = 4096;

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
  if (!node.exists() || !channel["sampler"].exists())
    return document.warn(target, "animation target", "an animation of something else than nodes is ignored");
  if (path != "weights" && path != "translation" && path != "rotation" && path != "scale")
    return document.warn(target, "animation path",
                         fmt::format("the animation of {} is ignored", in_quotes(path)));
  document.element("nodes", node);
  const Value sampler_value = Document::element(animation["samplers"], channel["sampler"]);
  const bool is_weights = path == "weights";
  KeyframeSampler sampler(sampler_value, accessors, is_weights ? 1 : path == "rotation" ? 4 : 3);
  if (is_weights) sampler.split_weights();
  if (sampler.empty())
    document.warn(sampler_value, "animation without keyframes", "has no keyframes; it is ignored");
  else
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
