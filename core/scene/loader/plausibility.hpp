// SPDX-License-Identifier: Apache-2.0
// Checks of a scene that need its assets. Stateless; thread-safe.
#pragma once

#include "core/scene/description.hpp"
#include "core/scene/loader/mistakes.hpp"
#include "core/scene/loader/scene_file.hpp"

namespace tessera::core {

// Checks what of materials depends on images and on other materials; also that no reflectance exceeds 1,
// which HDR textures could violate. `material_places` are the locations of the first materials; the others
// come from OBJ files' libraries.
void check_plausibility(const SceneDescription& scene, const std::vector<Place>& material_places,
                        const Place& shapes_place, Mistakes& mistakes);

}  // namespace tessera::core
