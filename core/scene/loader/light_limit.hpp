// SPDX-License-Identifier: Apache-2.0
// Limits the lights of a scene before they are created. Stateless; thread-safe.
#pragma once

#include "core/base/error.hpp"
#include "core/scene/description.hpp"
#include "core/scene/loader/scene_limits.hpp"

namespace tessera::core {

// RESOURCE_EXHAUSTED if the scene has more lights than the limit, or than can be numbered.
Status check_lights(const SceneDescription& scene, const SceneLimit& limit);

}  // namespace tessera::core
