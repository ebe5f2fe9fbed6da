// SPDX-License-Identifier: Apache-2.0
// The extent of a scene. Stateless; thread-safe.
#pragma once

#include "core/geometry/aabb.hpp"
#include "core/scene/description.hpp"

namespace tessera::core {

// A box around all shapes in world space, exact but for instances, which count by the box of their object.
// Empty without shapes. Takes time linear in the stored scene.
Aabb scene_bounds(const SceneDescription& scene);

}  // namespace tessera::core
