// Which light to sample, wherever the lit point is: nine times in ten in proportion to power, else any of
// them alike. So a faint light is still found beside one that is brighter by any factor, as a lamp under a
// sky is.
#pragma once

#include <cstdint>
#include <vector>

#include "core/sampling/distribution.hpp"

namespace tessera::core {

inline constexpr std::uint32_t kNoLight = 0xffffffffu;

class LightSampler {
 public:
  LightSampler() = default;
  // Of each light. One without power is never chosen.
  explicit LightSampler(const std::vector<double>& powers);

  struct Choice {
    std::uint32_t light;
    float pmf;
  };
  // Whether there is no light with power. Then none can be sampled.
  bool empty() const { return distribution_.empty(); }
  Choice sample(double u) const;
  float pmf(std::uint32_t light) const { return distribution_.pmf(light); }

 private:
  DiscreteDistribution distribution_;
};

}  // namespace tessera::core
