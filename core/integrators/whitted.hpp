// SPDX-License-Identifier: Apache-2.0
// Ray tracing after Whitted 1980: one sample of the radiance that arrives along a camera ray. It includes
// direct light at the first surface that is neither a mirror nor smooth glass, and at the surfaces seen
// through those. Other indirect light is left out, so images are darker than path traced ones.
#pragma once

#include "core/integrators/render_plan.hpp"

namespace tessera::core::integrators {

// Each light is sampled once; if there are more than this, the light sampler selects this many.
inline constexpr std::uint32_t kMaxWhittedLights = 16;
// Branches with a weight below this are not followed (Hall and Greenberg 1983).
inline constexpr float kMinWhittedShare = 1.0f / 4096;
// The maximum number of rays, apart from shadow rays: more than a tree of 15 consecutive forks can have.
inline constexpr int kMaxWhittedRays = 1 << 16;

// Counts rays in `counters`. Adds the light's parts to `parts`, if that is not null.
Rgb trace_whitted(const RenderPlan& plan, const sampling::Sampler& sampler, const Ray& ray,
                  RenderCounters& counters, LightParts* parts = nullptr);

}  // namespace tessera::core::integrators
