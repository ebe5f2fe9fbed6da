// SPDX-License-Identifier: Apache-2.0
#include "core/lights/lights_in_cone.hpp"

#include <algorithm>
#include <numbers>

#include "core/math/simd.hpp"

namespace tessera::core::lights {
namespace {

constexpr double kLargestBelowOne = 1 - 0x1p-53;

// Chooses one of `count` indices by weight_at(index); `sum` of them is positive. Makes of u a number for the
// next choice.
template <typename WeightAt>
std::size_t choose(std::size_t count, double sum, double& u, const WeightAt& weight_at) {
  const double sought = std::min(u, kLargestBelowOne) * sum;
  std::size_t chosen = 0;
  double below = 0, end = 0;
  for (std::size_t i = 0; i < count && end <= sought; ++i) {
    const auto weight = static_cast<double>(weight_at(i));
    if (!(weight > 0)) continue;
    chosen = i;
    below = end;
    end += weight;
  }
  u = std::min((sought - below) / (end - below), 1.0);
  return chosen;
}

double sum_of(const auto& lanes) {
  double sum = 0;
  for (const float lane : lanes) sum += static_cast<double>(lane);
  return sum;
}

FloatN lanes_of(const auto& lanes) {
  return FloatN::load(lanes.data());
}

}  // namespace

LightsInCone::LightsInCone(const LightTree& tree, const DoubleCone& cone) : tree_(tree), cone_(cone) {
  add_children(0);
  for (std::size_t i = 0; i < count_ && count_ + kWidth <= kMaxParts; ++i) {
    const std::int32_t child = child_at(parts_[i].place);
    if (child < 0) continue;
    parts_[i].weight = parts_[i].solid_angle = 0;
    add_children(static_cast<std::size_t>(child));
  }
  for (std::size_t i = 0; i < count_; ++i) {
    sum_ += static_cast<double>(parts_[i].weight);
    solid_angle_ += static_cast<double>(parts_[i].solid_angle);
  }
}

// A light counts by how much of it is in the cone, which goes linearly with the distance of its centre from
// the cone. A light is taken to be as large as a disk of its area, or as a sphere in its box: the sphere
// around the box of a lamp is almost twice as large. What that leaves out of a longish light is not found
// here. Inner nodes count in full.
LightsInCone::Children LightsInCone::children(std::size_t node) const {
  constexpr float kMinDistance2 = 1e-30f;
  constexpr float kNearest2 = 0.1f;  // of radius2: minimum distance for an apex among the lights
  const LightTree::Node& of = tree_.nodes_[node];
  const Vec3Of<FloatN> apex{cone_.apex.x, cone_.apex.y, cone_.apex.z},
      axis{cone_.axis.x, cone_.axis.y, cone_.axis.z};
  const Vec3Of<FloatN> center =
      Vec3Of<FloatN>{lanes_of(of.center[0]), lanes_of(of.center[1]), lanes_of(of.center[2])} - apex;
  const FloatN outside = length(cross(center, axis)) * cone_.cosine - fabs(dot(center, axis)) * cone_.sine;
  const FloatN radius2 = lanes_of(of.radius2), disk2 = lanes_of(of.disk2);
  unsigned leaves = 0;
  for (std::size_t lane = 0; lane < kWidth; ++lane) leaves |= (of.children[lane] < 0 ? 1u : 0u) << lane;
  const MaskN is_leaf = MaskN::from_bits(leaves);
  const FloatN radius = sqrt(select(is_leaf, min(radius2, max(disk2, radius2 * (1.0f / 3))), radius2));
  const FloatN within = min(max((radius - outside) / (2 * radius), 0.0f), 1.0f);
  const FloatN part = select(is_leaf, within, select(outside <= radius, FloatN(1.0f), FloatN(0.0f)));
  const FloatN per_distance2 = 1.0f / max(max(dot(center, center), kNearest2 * radius2), kMinDistance2);
  Children found;
  (lanes_of(of.intensity) * per_distance2 * part).store(found.weights.data());
  (disk2 * per_distance2 * part * std::numbers::pi_v<float>).store(found.solid_angles.data());
  return found;
}

void LightsInCone::add_children(std::size_t node) {
  const Children found = children(node);
  for (std::size_t lane = 0; lane < kWidth; ++lane) {
    if (!(found.weights[lane] > 0)) continue;
    const auto place = static_cast<std::uint32_t>(kWidth * node + lane);
    parts_[count_++] = {place, found.weights[lane], found.solid_angles[lane]};
  }
}

std::int32_t LightsInCone::child_at(std::uint32_t place) const {
  return tree_.nodes_[place / kWidth].children[place % kWidth];
}

LightTree::Choice LightsInCone::sample(double u) const {
  if (empty()) return {kNoLight, 0};
  const Part& part = parts_[choose(count_, sum_, u, [this](std::size_t i) { return parts_[i].weight; })];
  auto pmf = static_cast<float>(static_cast<double>(part.weight) / sum_);
  std::int32_t child = child_at(part.place);
  while (child >= 0) {
    const auto node = static_cast<std::size_t>(child);
    const auto weights = children(node).weights;
    const double sum = sum_of(weights);
    if (!(sum > 0)) return {kNoLight, 0};
    const std::size_t lane = choose(kWidth, sum, u, [&](std::size_t i) { return weights[i]; });
    pmf *= static_cast<float>(static_cast<double>(weights[lane]) / sum);
    child = tree_.nodes_[node].children[lane];
  }
  return {static_cast<std::uint32_t>(~child), pmf};
}

float LightsInCone::pmf(std::uint32_t light) const {
  if (empty() || !tree_.contains(light)) return 0;
  float pmf = 1;
  for (std::uint32_t place = tree_.leaves_[light];; place = tree_.nodes_[place / kWidth].parent) {
    const auto end = parts_.begin() + static_cast<std::ptrdiff_t>(count_);
    const auto part = std::find_if(parts_.begin(), end, [&](const Part& p) { return p.place == place; });
    if (part != end) return pmf * static_cast<float>(static_cast<double>(part->weight) / sum_);
    if (place < kWidth) return 0;
    const auto weights = children(place / kWidth).weights;
    const double sum = sum_of(weights);
    if (!(sum > 0)) return 0;
    pmf *= static_cast<float>(static_cast<double>(weights[place % kWidth]) / sum);
  }
}

}  // namespace tessera::core::lights
