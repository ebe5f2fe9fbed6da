#include "core/lights/light_sampler.hpp"

namespace tessera::core {

LightSampler::LightSampler(const std::vector<double>& powers) {
  constexpr double kUniformShare = 0.1;
  double total = 0, lights = 0;
  for (const double power : powers) {
    total += power;
    lights += power > 0 ? 1 : 0;
  }
  if (lights == 0) return;
  std::vector<double> weights;
  weights.reserve(powers.size());
  for (const double power : powers)
    weights.push_back(power > 0 ? (1 - kUniformShare) * power / total + kUniformShare / lights : 0);
  distribution_ = DiscreteDistribution(weights);
}

LightSampler::Choice LightSampler::sample(double u) const {
  const auto light = static_cast<std::uint32_t>(distribution_.sample(u));
  return {light, distribution_.pmf(light)};
}

}  // namespace tessera::core
