// SPDX-License-Identifier: Apache-2.0
// What the builders of guides share.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "core/lights/light_sample.hpp"
#include "core/lights/light_sampler.hpp"
#include "core/math/vec3.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core::integrators {

// Their random numbers are those of pixels that no image has, beside its first column.
inline constexpr std::uint64_t kGuideSeed = 0;
inline constexpr int kPhotonRow = -1, kOtherLightRow = -2, kCameraPathRow = -3, kLookRow = -4, kCellRow = -5;

// Guides are built for the middle of the time that the shutter is open. They choose among directions whose
// light is estimated without bias at any time.
inline constexpr float kGuideTime = 0.5f;

// Where a ray starts that leaves a surface on the side of `side_normal`.
inline Vec3 origin_above(Vec3 position, Vec3 side_normal) {
  const Vec3 a = abs(position);
  return position + side_normal * (1e-5f * std::max({a.x, a.y, a.z}));
}

// A sample of one light, whose number is `light`. `pdf` includes the choice of the light.
struct AnyLightSample : lights::LightSample {
  std::uint32_t light;
};
// Visibility is not tested. The first two of `u` sample the light that the others choose.
std::optional<AnyLightSample> sample_any_light(const Scene& scene, const lights::LightSampler& lights,
                                               const lights::LightSampleContext& point,
                                               const std::array<float, 4>& u,
                                               lights::MisCompensation compensation);

}  // namespace tessera::core::integrators
