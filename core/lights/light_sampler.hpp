// SPDX-License-Identifier: Apache-2.0
// Chooses which light to sample, depending on the reference point. Nine tenths of the choices are in
// proportion to each light's estimated unoccluded contribution, with a quarter for a uniform environment as
// suits multiple importance sampling. The others are uniform, so that faint lights are sampled beside
// arbitrarily bright ones.
//
// Local lights are chosen by a light tree. Lights at infinity, which are few, are weighed one by one beside
// it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/lights/light.hpp"
#include "core/lights/light_tree.hpp"
#include "core/math/lane_array.hpp"

namespace tessera::core {

class LightSampler {
 public:
  using Choice = LightTree::Choice;
  // The set of candidate lights.
  enum class Among { kAll, kDelta };

  LightSampler() = default;
  // Each light must have positive power. The result does not depend on `threads`.
  LightSampler(const std::vector<Light>& lights, Among among, int threads);

  // Whether there are no candidate lights.
  bool empty() const { return members_.empty(); }
  // The number of candidate lights.
  std::size_t size() const { return members_.size(); }
  // u is in [0, 1), with more bits than a float has. May return kNoLight if some lights do not reach the
  // point.
  Choice sample(const LightSampleContext& point, double u) const;
  // Samples for eight points; each lane equals the above. Lanes whose bit in `asked` is not set stay empty.
  std::array<Choice, kLaneCount> sample(const LightSampleContexts& points,
                                        const std::array<double, kLaneCount>& u, unsigned asked) const;
  // The probability with which sample() chooses the light; 0 if it never does.
  float pmf(const LightSampleContext& point, std::uint32_t light) const;

 private:
  // A light at infinity.
  struct Distant {
    std::uint32_t light;
    Vec3 wi{};              // unit
    double irradiance = 0;  // of a surface that faces it, averaged over the channels
    // Replaces the members above for environment light: EnvironmentDistribution::importance_by_normal, by
    // normal_bin().
    std::vector<double> by_facing{};
  };
  // Values at a point that do not depend on the light, cached before a light is chosen there.
  struct ShadingPointCache {
    LightSampleContext point;
    LightTree::Weights root;
    std::uint32_t facing;  // normal_bin() of its normal; kAllSides if there is no environment light
  };
  // The total contributions of the tree and of the lights at infinity, and the number of non-zero
  // alternatives.
  struct Total {
    double tree = 0, irradiance = 0;
    int alternatives = 0;
  };

  ShadingPointCache shading_point_cache(const LightSampleContext& point) const;
  static double irradiance(const Distant& distant, const ShadingPointCache& at);
  Total total(const ShadingPointCache& at) const;
  static double share(const Total& total, double irradiance);
  Choice sample_at(const ShadingPointCache& at, double u) const;
  Choice sample_by_place(const ShadingPointCache& at, double u) const;
  // Nothing for lights outside the candidates.
  std::optional<float> pmf_by_place(const ShadingPointCache& at, std::uint32_t light) const;

  std::vector<std::uint32_t> members_;
  LightTree tree_;
  std::vector<Distant> distant_;
  bool any_all_around_ = false;
};

}  // namespace tessera::core
