#include "core/lights/light_sampler.hpp"

namespace tessera::core {

LightSampler::LightSampler(const std::vector<Light>& lights) {
  constexpr double kUniformShare = 0.1;
  double total = 0;
  for (const Light& light : lights) total += light.power();
  std::vector<double> weights;
  weights.reserve(lights.size());
  for (const Light& light : lights)
    weights.push_back((1 - kUniformShare) * light.power() / total +
                      kUniformShare / static_cast<double>(lights.size()));
  distribution_ = DiscreteDistribution(weights);
}

std::optional<LightSampler::Choice> LightSampler::sample(double u) const {
  if (distribution_.empty()) return std::nullopt;
  const auto light = static_cast<std::uint32_t>(distribution_.sample(u));
  return Choice{light, distribution_.pmf(light)};
}

}  // namespace tessera::core
