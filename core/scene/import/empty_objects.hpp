// SPDX-License-Identifier: Apache-2.0
// Removes objects that turned out to have no shape. Stateless; thread-safe.
#pragma once

#include "core/scene/description.hpp"

namespace tessera::core {

// Removes objects without shapes, and their instances. The other shapes and objects keep their order.
void remove_empty_objects(SceneDescription& scene);

}  // namespace tessera::core
