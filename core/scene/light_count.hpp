// SPDX-License-Identifier: Apache-2.0
// Counts the area lights that a scene will have: one for each emissive triangle, quad, sphere, disk and
// cylinder, once per instance.
#pragma once

#include <cstdint>

#include "core/scene/description.hpp"

namespace tessera::core {

// An upper bound on what Scene::build creates: shapes with black emission textures count too. Takes time
// linear in the stored scene, whatever the number of instances. The scene must be a result of load_scene(),
// in which all materials and objects exist.
std::uint64_t count_area_lights(const SceneDescription& scene);

}  // namespace tessera::core
