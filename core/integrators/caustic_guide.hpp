// SPDX-License-Identifier: Apache-2.0
// Learns where caustics come from, and what they light: light that passes mirrors, glass or polished metal on
// its way from a light to a surface, which next-event estimation cannot find.
#pragma once

#include <vector>

#include "core/guiding/light_guide.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core {

// What the settings' integrator can use of it; nothing where there are no caustics. Made at the first call
// for a scene, by up to `threads` threads, whose number makes no difference; it takes some tenths of a
// second. Lives as long as the scene.
const LightGuide* caustic_guide(const Scene& scene, const RenderSettings& settings, int threads);

// The photons that the guide is made of.
std::vector<Photon> trace_caustic_photons(const Scene& scene, int threads);

}  // namespace tessera::core
