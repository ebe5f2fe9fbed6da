// Path tracing (Kajiya 1986): one sample of the radiance that arrives along a camera ray.
#pragma once

#include "core/film/film.hpp"
#include "core/sampling/sampler.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core {

// Unbiased whatever the strategy, but for settings.max_depth. Rays are counted in `counters`.
Rgb trace_path(const Scene& scene, const RenderSettings& settings, const Sampler& sampler, Ray ray,
               RenderCounters& counters);

}  // namespace tessera::core
