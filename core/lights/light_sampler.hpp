// SPDX-License-Identifier: Apache-2.0
// Which light to sample, by where the lit point is: nine times in ten in proportion to the light that each
// may send there, shadows apart, of a uniform environment a quarter of it,
// as it suits multiple importance sampling; else any of them alike. So a faint
// light is still found beside one that is brighter by any factor.
//
// Lights with a place are chosen by a tree. Those at infinity, which are few, stand beside it one by one.
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
  // Which of the lights can be chosen.
  enum class Among { kAll, kDelta };

  LightSampler() = default;
  // Each light has power. The result does not depend on `threads`.
  LightSampler(const std::vector<Light>& lights, Among among, int threads);

  // Whether there is no light that could be chosen.
  bool empty() const { return members_.empty(); }
  // How many lights can be chosen.
  std::size_t size() const { return members_.size(); }
  // u in [0, 1), of more bits than a float has. May choose none (kNoLight) where there are lights that do not
  // shine on the point.
  Choice sample(const LightSampleContext& point, double u) const;
  // For eight points, each lane as the above; nothing in lanes whose bit in `asked` is not set.
  std::array<Choice, kLaneCount> sample(const LightSampleContexts& points,
                                        const std::array<double, kLaneCount>& u, unsigned asked) const;
  // With which sample() chooses the light; 0 of one that it never does.
  float pmf(const LightSampleContext& point, std::uint32_t light) const;

 private:
  // A light at infinity.
  struct Distant {
    std::uint32_t light;
    Vec3 wi{};              // unit
    double irradiance = 0;  // of a surface that faces it, the mean of the channels
    // Instead of these, for environment light: EnvironmentDistribution::importance_by_normal, by
    // normal_bin().
    std::vector<double> by_facing{};
  };
  // A point, and what is found out about it before any light is chosen there.
  struct ShadingPointCache {
    LightSampleContext point;
    LightTree::Weights root;
    std::uint32_t facing;  // normal_bin() its normal; kAllSides, and not asked for, if no light is all around
  };
  // How much light comes from the tree and from all at infinity, and from how many of these alternatives.
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
  // Nothing of lights that are not among these.
  std::optional<float> pmf_by_place(const ShadingPointCache& at, std::uint32_t light) const;

  std::vector<std::uint32_t> members_;
  LightTree tree_;
  std::vector<Distant> distant_;
  bool any_all_around_ = false;
};

}  // namespace tessera::core
