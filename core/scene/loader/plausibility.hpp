// SPDX-License-Identifier: Apache-2.0
// What can be told wrong about a scene only when its assets are there. Stateless; thread-safe.
#pragma once

#include "core/scene/description.hpp"
#include "core/scene/loader/mistakes.hpp"
#include "core/scene/loader/scene_file.hpp"

namespace tessera::core {

// Nothing reflects more light than it gets, as HDR textures might say. `material_places` are those of the
// first materials; the others come from the shapes' own libraries.
void check_plausibility(const SceneDescription& scene, const std::vector<Place>& material_places,
                        const Place& shapes_place, Mistakes& mistakes);

}  // namespace tessera::core
