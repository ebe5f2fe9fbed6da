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

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/lights/light.hpp"
#include "core/lights/light_tree.hpp"
#include "core/math/lane_array.hpp"

namespace tessera::core::lights {

class LightSampler {
 public:
  using Choice = LightTree::Choice;
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
  // Samples for points in lanes; each lane equals the above. Lanes whose bit in `asked` is not set stay
  // empty.
  std::array<Choice, kLaneCount> sample(const LightSampleContexts& points,
                                        const std::array<double, kLaneCount>& u, unsigned asked,
                                        MisCompensation compensation = MisCompensation::kOff) const;
  // The probability with which sample() chooses the light; 0 if it never does.
  float pmf(const LightSampleContext& point, std::uint32_t light,
            MisCompensation compensation = MisCompensation::kOff) const;

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
  // Values at a point that do not depend on the light, cached before a light is chosen there.
  struct ShadingPointCache {
    LightSampleContext point;
    LightTree::Weights root;
    std::uint32_t facing;  // normal_bin() of its normal; kAllSides if there is no environment light
    MisCompensation compensation;
  };
  // What a candidate counts in the choice: its estimated contribution, and its part of the choices that do
  // not go by contribution, in [0, 1].
  struct Weight {
    double irradiance = 0, even = 0;
  };
  // The weights of the tree and of the environment, and the sums over these and the distant lights.
  struct Weights {
    Weight tree, environment, sum;
  };

  ShadingPointCache shading_point_cache(const LightSampleContext& point, MisCompensation compensation) const;
  static Weight weight(double irradiance) { return {irradiance, irradiance > 0 ? 1.0 : 0.0}; }
  static Weight weight(const Distant& distant, const ShadingPointCache& at);
  Weight environment_weight(const ShadingPointCache& at, double others) const;
  Weights weights(const ShadingPointCache& at) const;
  static double share(const Weights& all, const Weight& weight);
  // The number of lights among which choices are uniform, and the probability of each of them.
  std::size_t uniform_count(MisCompensation compensation) const;
  double uniform_pmf(MisCompensation compensation) const;
  bool spared(std::uint32_t light, MisCompensation compensation) const;
  float with_uniform(const ShadingPointCache& at, const Choice& by_place) const;
  Choice sample_at(const ShadingPointCache& at, double u) const;
  Choice sample_by_place(const ShadingPointCache& at, double u) const;
  // Nothing for lights outside the candidates.
  std::optional<float> pmf_by_place(const ShadingPointCache& at, std::uint32_t light) const;

  std::vector<std::uint32_t> members_;  // the environment last
  LightTree tree_;
  std::vector<Distant> distant_;
  std::optional<EnvironmentLight> environment_;
};

}  // namespace tessera::core::lights
