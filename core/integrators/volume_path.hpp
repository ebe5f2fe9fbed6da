// SPDX-License-Identifier: Apache-2.0
// Path tracing in scenes with participating media, one path at a time: one sample of the radiance that
// arrives along a camera ray. Paths scatter at surfaces and in media (Lafortune and Willems 1996); shadow
// rays are attenuated by both. Scenes without media take the batches of path.hpp.
#pragma once

#include "core/integrators/render_plan.hpp"

namespace tessera::core::integrators {

// Unbiased with every strategy, as PathTracer. Counts rays in `counters`. Adds the light's parts to
// `parts`, if that is not null.
Rgb trace_volume_path(const RenderPlan& plan, const sampling::Sampler& sampler, const Ray& ray,
                      RenderCounters& counters, LightParts* parts = nullptr);

}  // namespace tessera::core::integrators
