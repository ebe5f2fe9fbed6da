#include "core/lights/light_sampler.hpp"

namespace tessera::core {

LightSampler::LightSampler(const std::vector<Light>& lights) {
  std::vector<double> powers;
  powers.reserve(lights.size());
  for (const Light& light : lights) powers.push_back(light.power());
  distribution_ = DiscreteDistribution(powers);
}

std::optional<LightSampler::Choice> LightSampler::sample(float u) const {
  if (distribution_.empty()) return std::nullopt;
  const auto light = static_cast<std::uint32_t>(distribution_.sample(u));
  return Choice{light, distribution_.pmf(light)};
}

}  // namespace tessera::core
