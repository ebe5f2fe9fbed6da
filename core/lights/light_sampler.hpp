// SPDX-License-Identifier: Apache-2.0
// Chooses which light to sample, depending on the reference point. Nine tenths of the choices are in
// proportion to each light's estimated unoccluded contribution. The others are uniform, so that faint lights
// are sampled beside arbitrarily bright ones.
//
// Local lights are chosen by a light tree. Lights at infinity, which are few, are weighed one by one beside
// it. What the environment counts depends on MisCompensation:
// - Off: high-contrast parts such as a sun count in full, and uniform ones a quarter.
// - On: BSDF samples find the environment, too, so light samples of it are worth what they add. Let a
//   surface receive the irradiance E from all other lights, Y from a uniform environment and X from what is
//   brighter. The compensated tables of the environment give (Y - X) / 2 to the uniform part where that is
//   positive, and the rest to X. All lights together (after Karlík et al. 2019) would give it (Y - X - E) /
//   2; it is (W (Y - X) - E) / 2, where W is less than 1, because highlights and shadows of lamps have
//   sharper edges. So a lamp gets all light samples unless the sky is many times as bright; a lamp and a sky
//   whose light is mostly that of its sun are weighed by irradiance.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/lights/light.hpp"
#include "core/lights/light_tree.hpp"
#include "core/math/lane_array.hpp"
#include "core/math/word_lanes.hpp"

namespace tessera::core::lights {

class LightSampler {
 public:
  using Choice = LightTree::Choice;
  using ChoicesInLanes = LightTree::ChoicesInLanes;
  // The set of candidate lights.
  enum class Among { kAll, kDelta };

  LightSampler() = default;
  // Each light must have positive power, and at most one is an environment. The result does not depend on
  // `threads`.
  LightSampler(const std::vector<Light>& lights, Among among, int threads);

  // Whether there are no candidate lights.
  bool empty() const { return members_.empty(); }
  // The number of candidate lights.
  std::size_t size() const { return members_.size(); }
  // u is in [0, 1), with more bits than a float has. May return kNoLight if some lights do not reach the
  // point.
  Choice sample(const LightSampleContext& point, double u,
                MisCompensation compensation = MisCompensation::kOff) const;
  // Samples for points in lanes; each lane whose bit in `asked` is set equals the above.
  ChoicesInLanes sample(const LightSampleContexts& points, const DoubleLanes& u, unsigned asked,
                        MisCompensation compensation = MisCompensation::kOff) const;
  // The probability with which sample() chooses the light; 0 if it never does.
  float pmf(const LightSampleContext& point, std::uint32_t light,
            MisCompensation compensation = MisCompensation::kOff) const;
  // That of the environment, which is among the candidates.
  template <typename T>
  T environment_pmf(const LightSampleContextOf<T>& point, MisCompensation compensation) const;

 private:
  // A directional light.
  struct Distant {
    std::uint32_t light;
    Vec3 wi;            // unit
    double irradiance;  // of a surface that faces it, averaged over the channels
  };
  struct EnvironmentLight {
    std::uint32_t light;
    std::vector<EnvironmentDistribution::Importance> by_facing;  // by normal_bin()
  };
  // Values at a point that do not depend on the light.
  template <typename T>
  struct ShadingPointOf {
    LightSampleContextOf<T> context;
    LightTree::WeightsOf<T> root;
    WordOf<T> facing;  // normal_bin() of its normal; kAllSides if there is no environment light
    MisCompensation compensation;
  };
  using ShadingPoint = ShadingPointOf<float>;
  // What a candidate counts in the choice: its estimated contribution, and its part of the choices that do
  // not go by contribution, in [0, 1].
  template <typename T>
  struct WeightOf {
    WideOf<T> irradiance, even;
  };
  // The weights of the tree and of the environment, and the sums over these and the distant lights.
  template <typename T>
  struct WeightsOf {
    WeightOf<T> tree, environment, sum;
  };
  // A choice by place. In lanes of `in_tree`, the light is yet to be chosen in the tree, by u, and pmf is the
  // tree's.
  template <typename T>
  struct PlaceChoiceOf {
    WordOf<T> light;
    T pmf;
    MaskOf<T> in_tree;
    WideOf<T> u;
  };

  template <typename T>
  ShadingPointOf<T> shading_point(const LightSampleContextOf<T>& context, MisCompensation compensation) const;
  template <typename T>
  static WeightOf<T> weight(WideOf<T> irradiance);
  template <typename T>
  static WideOf<T> share(const WeightOf<T>& sum, const WeightOf<T>& weight);
  template <typename T>
  static WeightOf<T> weight(const Distant& distant, const ShadingPointOf<T>& at);
  template <typename T>
  WeightOf<T> environment_weight(const ShadingPointOf<T>& at, WideOf<T> others) const;
  template <typename T>
  WeightsOf<T> weights(const ShadingPointOf<T>& at) const;
  template <typename T>
  PlaceChoiceOf<T> choose_by_place(const ShadingPointOf<T>& at, WideOf<T> u) const;
  void choose_uniformly(const ShadingPointOf<FloatN>& at, const DoubleLanes& u, unsigned lanes,
                        ChoicesInLanes& choices) const;
  bool spares_environment(MisCompensation compensation) const;
  // The number of lights among which choices are uniform, and the probability of each of them.
  std::size_t uniform_count(MisCompensation compensation) const;
  double uniform_pmf(MisCompensation compensation) const;
  // The light of a u that chooses uniformly.
  std::uint32_t uniform_light(double u, MisCompensation compensation) const;
  template <typename T>
  T with_uniform(WordOf<T> light, T pmf_by_place, MisCompensation compensation) const;
  // Nothing for lights outside the candidates.
  std::optional<float> pmf_by_place(const ShadingPoint& at, std::uint32_t light) const;

  std::vector<std::uint32_t> members_;  // the environment last
  LightTree tree_;
  std::vector<Distant> distant_;
  std::optional<EnvironmentLight> environment_;
};

}  // namespace tessera::core::lights
