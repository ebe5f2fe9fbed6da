// SPDX-License-Identifier: Apache-2.0
// Ray tracing after Whitted 1980: one sample of the radiance that arrives along a camera ray, of the light
// that comes straight from lights to the first surface that is neither a mirror nor smooth glass, and to what
// those show. Light that is scattered more than once elsewhere is left out, so pictures are darker than path
// tracing's.
#pragma once

#include "core/film/film.hpp"
#include "core/sampling/sampler.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core {

// Each light is sampled once; where there are more than this, as many of them by the light sampler.
inline constexpr std::uint32_t kMaxWhittedLights = 16;
// Branches of the tree of rays are not followed that would carry less than this of what they see (Hall and
// Greenberg 1983).
inline constexpr float kMinWhittedShare = 1.0f / 4096;
// Nor are more rays than these, beside those towards lights: more than a tree of 15 forks in a row can have.
inline constexpr int kMaxWhittedRays = 1 << 16;

// Rays are counted in `counters`.
Rgb trace_whitted(const Scene& scene, const RenderSettings& settings, const Sampler& sampler, const Ray& ray,
                  RenderCounters& counters);

}  // namespace tessera::core
