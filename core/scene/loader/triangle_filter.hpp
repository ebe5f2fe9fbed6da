// SPDX-License-Identifier: Apache-2.0
// Removes redundant triangles from a mesh. Stateless; thread-safe.
#pragma once

#include "core/scene/description.hpp"

namespace tessera::core {

// Removes triangles without area, and those that coincide with an earlier one facing the same way: rays hit
// the earlier one, but as lights both would count. The others keep their order.
void remove_superfluous_triangles(MeshDescription& mesh);

}  // namespace tessera::core
