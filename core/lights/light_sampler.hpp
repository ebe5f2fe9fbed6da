// Which light to sample, wherever the lit point is: nine times in ten in proportion to power, else any of
// them alike. So a faint light is still found beside one that is brighter by any factor, as a lamp under a
// sky is.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/lights/light.hpp"
#include "core/sampling/distribution.hpp"

namespace tessera::core {

inline constexpr std::uint32_t kNoLight = 0xffffffffu;

class LightSampler {
 public:
  LightSampler() = default;
  explicit LightSampler(const std::vector<Light>& lights);

  struct Choice {
    std::uint32_t light;
    float pmf;
  };
  // Nothing where there is no light with power.
  std::optional<Choice> sample(double u) const;
  float pmf(std::uint32_t light) const { return distribution_.pmf(light); }

 private:
  DiscreteDistribution distribution_;
};

}  // namespace tessera::core
