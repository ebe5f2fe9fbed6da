// SPDX-License-Identifier: Apache-2.0
// Learns where caustics come from and which surfaces they illuminate: light that passes mirrors, glass or
// polished metal between a light and a surface, which next-event estimation cannot sample.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/guiding/light_guide.hpp"
#include "core/lights/light_sampler.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core::integrators {

// The number of photon paths of every render; each deposits any number of photons.
inline constexpr std::uint32_t kPhotonPaths = 1u << 17, kPhotonPathsAtOnce = 1u << 10;

// The guide of a scene without media; empty if the scene has no caustics. `lights` samples all lights. Takes
// some tenths of a second with up to `threads` threads; the result does not depend on `threads`.
guiding::LightGuide build_caustic_guide(const Scene& scene, const lights::LightSampler& lights,
                                        std::span<const guiding::Photon> photons, int threads);

// Traces the photons from which the guide is built. `photon_paths` is a multiple of kPhotonPathsAtOnce.
std::vector<guiding::Photon> trace_caustic_photons(const Scene& scene, const lights::LightSampler& lights,
                                                   int threads, std::uint32_t photon_paths = kPhotonPaths);

}  // namespace tessera::core::integrators
