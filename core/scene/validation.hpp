// SPDX-License-Identifier: Apache-2.0
// The checks that a scene must pass to be built, without building it.
#pragma once

#include "core/base/error.hpp"
#include "core/scene/description.hpp"

namespace tessera::core {

// Whether Scene::build will accept `scene`. Errors (INVALID_ARGUMENT) name the shape, material or field at
// fault.
Status validate_scene(const SceneDescription& scene);

// Whether a valid scene has a light, an environment or a shape that emits. Else its picture is black, which
// is seldom meant.
bool gives_light(const SceneDescription& scene);

}  // namespace tessera::core
