// SPDX-License-Identifier: Apache-2.0
// The media inside clear solids that absorb light.
#pragma once

#include "core/scene/description.hpp"

namespace tessera::core {

// Fills each material that absorbs_inside() and names no media of its own with a medium in which light has
// the transmission colour at the transmission depth (Beer's law). The scene must be valid.
void add_absorbing_media(SceneDescription& scene);

}  // namespace tessera::core
