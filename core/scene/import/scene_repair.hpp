// SPDX-License-Identifier: Apache-2.0
// Replaces what Scene::build would refuse in a scene of another program, so that the rest can be rendered.
// Stateless; thread-safe.
#pragma once

#include "core/scene/description.hpp"
#include "core/scene/loader/file_warnings.hpp"

namespace tessera::core {

// Materials that cannot be computed with become gray, or lose their emission; media become vacuum; instances
// and an environment are left out. Each is told.
void leave_out_invalid_parts(SceneDescription& scene, FileWarnings& warnings);

// Whether the camera can be rendered with; else it is told, and stops moving.
bool is_valid_view(SceneDescription& scene, FileWarnings& warnings);

}  // namespace tessera::core
