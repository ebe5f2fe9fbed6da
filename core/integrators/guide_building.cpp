// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/guide_building.hpp"

#include "core/integrators/direct_light.hpp"

namespace tessera::core::integrators {

std::optional<AnyLightSample> sample_any_light(const Scene& scene, const lights::LightSampler& lights,
                                               const lights::LightSampleContext& point,
                                               const std::array<float, 4>& u,
                                               lights::MisCompensation compensation) {
  const auto [light, pmf] = lights.sample(point, combine_uniforms(u[2], u[3]), compensation);
  if (light == lights::kNoLight) return std::nullopt;
  auto sample =
      sample_light(scene.lights()[light], scene.textures(), point, {u[0], u[1]}, compensation, kGuideTime);
  if (!sample) return std::nullopt;
  sample->pdf *= pmf;
  return AnyLightSample{*sample, light};
}

}  // namespace tessera::core::integrators
