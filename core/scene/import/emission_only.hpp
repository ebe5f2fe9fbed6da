// SPDX-License-Identifier: Apache-2.0
// Scenes of which only the light is seen that reaches the camera without scattering: a maximum depth that our
// settings lack. Stateless; thread-safe.
#pragma once

#include "core/scene/description.hpp"

namespace tessera::core {

// Makes all surfaces black that scatter light, and all media absorb what they scattered. What light passes
// straight through stays. False if there is a medium whose scattering has a grid of its own: it does not
// weaken light any more.
bool show_emission_only(SceneDescription& scene);

}  // namespace tessera::core
