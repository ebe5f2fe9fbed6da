// SPDX-License-Identifier: Apache-2.0
// Validates a scene without building it.
#pragma once

#include "core/base/error.hpp"
#include "core/scene/description.hpp"

namespace tessera::core {

// Checks that Scene::build will accept `scene`. Errors (INVALID_ARGUMENT) name the invalid shape, material
// or field.
Status validate_scene(const SceneDescription& scene);

// Whether a valid scene has a light, an environment or an emissive shape. Otherwise its image is black,
// which is seldom intended.
bool gives_light(const SceneDescription& scene);

}  // namespace tessera::core
