// SPDX-License-Identifier: Apache-2.0
// A tree over the local lights that chooses one in proportion to its estimated contribution to a point
// (Conty Estevez and Kulla 2018), with eight children per node. The cost is logarithmic in the number of
// lights. Immutable, shared by all threads.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <type_traits>
#include <vector>

#include "core/lights/light_bounds.hpp"
#include "core/lights/light_sample_context.hpp"
#include "core/math/simd_double.hpp"
#include "core/math/vec3.hpp"
#include "core/math/word_lanes.hpp"

namespace tessera::core::lights {

inline constexpr std::uint32_t kNoLight = 0xffffffffu;

class LightTree {
 public:
  static constexpr std::size_t kWidth = kLaneCount;

  struct Item {
    LightBounds bounds;
    std::uint32_t light;
  };

  LightTree() = default;
  // The result does not depend on `threads`.
  static LightTree build(std::vector<Item> items, int threads);

  bool empty() const { return nodes_.empty(); }

  template <typename T>
  struct ChoiceOf {
    WordOf<T> light;  // kNoLight: no candidate light reaches the point
    T pmf;
  };
  using Choice = ChoiceOf<float>;
  using ChoicesInLanes = ChoiceOf<FloatN>;
  class Weights;
  class WeightsInLanes;
  template <typename T>
  using WeightsOf = std::conditional_t<std::is_same_v<T, float>, Weights, WeightsInLanes>;
  // The weights of the root's children, as input of the functions below.
  Weights weigh_root(const LightSampleContext& point) const;
  WeightsInLanes weigh_root(const LightSampleContexts& points) const;
  // u is in [0, 1], with more bits than a float has.
  Choice sample(const Weights& root, const LightSampleContext& point, double u) const;
  Choice sample(const LightSampleContext& point, double u) const;
  // In lanes whose bits are set in `asked`.
  ChoicesInLanes sample(const WeightsInLanes& roots, const LightSampleContexts& points, DoubleN u,
                        unsigned asked) const;
  // The probability with which sample() chooses the light.
  float pmf(const Weights& root, const LightSampleContext& point, std::uint32_t light) const;
  float pmf(const LightSampleContext& point, std::uint32_t light) const;
  bool contains(std::uint32_t light) const { return light < leaves_.size() && leaves_[light] != kNoLeaf; }
  // The approximate unoccluded irradiance, averaged over the channels. Zero only if no light arrives, up to
  // rounding.
  double irradiance(const Weights& root) const;
  DoubleN irradiance(const WeightsInLanes& roots) const;
  double irradiance(const LightSampleContext& point) const;

 private:
  friend class LightTreeBuilder;
  friend class LightsInCone;

  using Lanes = std::array<float, kWidth>;

  // The children of a node as a structure of arrays. A child is a node or a light.
  struct alignas(64) Node {
    Lanes center[3]{}, radius2{};  // bounding sphere of the lights
    Lanes disk2{};                 // squared radius of a disk with the lights' area
    Lanes axis[3]{}, cos_o{}, sin_o{}, cos_e{};
    Lanes back{};                                 // factor of the cosine to the axis on the back: -1 or 1
    Lanes intensity{};                            // as a fraction of power_; 0 without a child
    std::array<std::int32_t, kWidth> children{};  // a node's index, or ~ of a light's index
    std::uint32_t parent = 0;                     // kWidth * parent + lane of this node
  };
  // A lane of a node, as kWidth * node + lane.
  static constexpr std::uint32_t kNoLeaf = 0xffffffffu;

  struct Children;
  static Weights weigh(const Node& node, const LightSampleContext& point);
  static std::int32_t choose_child(const Node& node, const Weights& weights, double& u, float& pmf);
  Choice sample_below(std::int32_t child, const LightSampleContext& point, double u, float pmf) const;
  // The light that sample() always chooses, if there is just one.
  std::optional<std::uint32_t> only_light() const;

  std::vector<Node> nodes_;            // the root first
  std::vector<std::uint32_t> leaves_;  // the lane of each light
  double power_ = 0;                   // of all lights
};

// The estimated contributions of a node's children to a point, and their prefix sums.
class LightTree::Weights {
 public:
  double sum() const { return sums.back(); }

 private:
  friend LightTree;

  friend WeightsInLanes;

  void add_up();
  float share(std::size_t lane) const { return static_cast<float>(static_cast<double>(lanes[lane]) / sum()); }

  alignas(32) Lanes lanes;
  std::array<double, kWidth> sums;
};

// The same for points in lanes.
class LightTree::WeightsInLanes {
 public:
  DoubleN sum() const { return sum_; }
  Weights operator[](std::size_t lane) const;

 private:
  friend LightTree;

  alignas(32) std::array<Lanes, kWidth> of_children_{};  // of each child, to the points
  DoubleN sum_ = 0.0;
};

inline double LightTree::irradiance(const Weights& root) const {
  return root.sum() * power_;
}
inline DoubleN LightTree::irradiance(const WeightsInLanes& roots) const {
  return roots.sum() * power_;
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

}  // namespace tessera::core::lights
