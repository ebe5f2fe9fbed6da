// SPDX-License-Identifier: Apache-2.0
// Learns where caustics come from and which surfaces they illuminate: light that passes mirrors, glass or
// polished metal between a light and a surface, which next-event estimation cannot sample.
#pragma once

#include <vector>

#include "core/guiding/light_guide.hpp"
#include "core/scene/scene.hpp"

namespace tessera::core {

// The guide for the settings' integrator; null if the integrator uses none or the scene has no caustics.
// The first call for a scene builds it with up to `threads` threads, which takes some tenths of a second;
// the result does not depend on `threads`. It lives as long as the scene.
const LightGuide* caustic_guide(const Scene& scene, const RenderSettings& settings, int threads);

// Traces the photons from which the guide is built.
std::vector<Photon> trace_caustic_photons(const Scene& scene, int threads);

}  // namespace tessera::core
