// SPDX-License-Identifier: Apache-2.0
// Removes shapes that cannot be rendered, and objects that turned out to have none. Stateless; thread-safe.
#pragma once

#include <cstddef>
#include <vector>

#include "core/scene/description.hpp"

namespace tessera::core {

// Removes objects without shapes, and their instances. The other shapes and objects keep their order.
void remove_empty_objects(SceneDescription& scene);

// Removes the scene's shapes of these indices, and their motions. The others keep their order.
void remove_shapes(SceneDescription& scene, const std::vector<std::size_t>& indices);

}  // namespace tessera::core
