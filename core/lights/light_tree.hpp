// SPDX-License-Identifier: Apache-2.0
// A tree over the lights that have a place, to choose one in proportion to the light that it may send to a
// point (Conty Estevez and Kulla 2018), with nodes of eight. The cost grows with the logarithm of the number
// of lights. Immutable, shared by all threads.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/lights/light_bounds.hpp"
#include "core/lights/light_sample_context.hpp"
#include "core/math/simd.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

inline constexpr std::uint32_t kNoLight = 0xffffffffu;

class LightTree {
 public:
  static constexpr std::size_t kWidth = 8;

  struct Item {
    LightBounds bounds;
    std::uint32_t light;
  };

  LightTree() = default;
  // The result does not depend on `threads`.
  static LightTree build(std::vector<Item> items, int threads);

  bool empty() const { return nodes_.empty(); }

  struct Choice {
    std::uint32_t light;  // kNoLight: of those that might have been chosen, none shines here
    float pmf;
  };
  class Weights;
  // Of the root's children, as the following take it.
  Weights weigh_root(const LightSampleContext& point) const;
  // Of eight points.
  std::array<Weights, kWidth> weigh_root(const LightSampleContexts& points) const;
  // u in [0, 1], of more bits than a float has.
  Choice sample(const Weights& root, const LightSampleContext& point, double u) const;
  Choice sample(const LightSampleContext& point, double u) const;
  // With which sample() chooses the light.
  float pmf(const Weights& root, const LightSampleContext& point, std::uint32_t light) const;
  float pmf(const LightSampleContext& point, std::uint32_t light) const;
  bool contains(std::uint32_t light) const { return light < leaves_.size() && leaves_[light] != kNoLeaf; }

  // About how much light arrives, shadows apart: irradiance, the mean of the channels. Zero only where
  // rounding might decide whether any does.
  double irradiance(const Weights& root) const;
  double irradiance(const LightSampleContext& point) const;

 private:
  friend class LightTreeBuilder;

  using Lanes = std::array<float, kWidth>;

  // Its children by coordinate. A child is a node or a light.
  struct alignas(64) Node {
    Lanes center[3]{}, radius2{};  // of a sphere around the lights
    Lanes disk2{};                 // the squared radius of a disk of the lights' area
    Lanes axis[3]{}, cos_o{}, sin_o{}, cos_e{};
    Lanes back{};       // what the cosine to the axis is multiplied by on the back: -1 or 1
    Lanes intensity{};  // as a share of power_; 0 where there is no child
    std::array<std::int32_t, kWidth> children{};  // a node's index, or ~ a light's
    std::uint32_t parent = 0;                     // the lane that the node is in, of its parent
  };
  // A lane of a node: kWidth * node + lane.
  static constexpr std::uint32_t kNoLeaf = 0xffffffffu;

  struct Children;
  static Weights weigh(const Node& node, const LightSampleContext& point);

  std::vector<Node> nodes_;            // the root first
  std::vector<std::uint32_t> leaves_;  // of each light, its lane
  double power_ = 0;                   // of all lights
};

// How much light a node's children may send to a point, and their sums up to and with each.
class LightTree::Weights {
 public:
  double sum() const { return sums.back(); }

 private:
  friend LightTree;

  void add_up();
  float share(std::size_t lane) const { return static_cast<float>(static_cast<double>(lanes[lane]) / sum()); }

  alignas(32) Lanes lanes;
  std::array<double, kWidth> sums;
};

inline double LightTree::irradiance(const Weights& root) const {
  return root.sum() * power_;
}
inline double LightTree::irradiance(const LightSampleContext& point) const {
  return irradiance(weigh_root(point));
}
inline LightTree::Choice LightTree::sample(const LightSampleContext& point, double u) const {
  return sample(weigh_root(point), point, u);
}
inline float LightTree::pmf(const LightSampleContext& point, std::uint32_t light) const {
  return pmf(weigh_root(point), point, light);
}

}  // namespace tessera::core
