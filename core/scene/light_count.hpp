// SPDX-License-Identifier: Apache-2.0
// How many area lights a scene has when it is built: one for each emissive triangle, quad and sphere, again
// for every instance of an object.
#pragma once

#include <cstdint>

#include "core/scene/description.hpp"

namespace tessera::core {

// No fewer than Scene::build makes: shapes whose texture leaves them black count too. Takes time linear in
// the scene as it is stored, whatever the number of instances. The scene must be one that load_scene()
// assembles: materials and objects that it names exist.
std::uint64_t count_area_lights(const SceneDescription& scene);

}  // namespace tessera::core
