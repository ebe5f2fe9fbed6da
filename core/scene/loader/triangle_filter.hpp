// SPDX-License-Identifier: Apache-2.0
// Leaves out of a mesh what no ray can tell from its absence. Stateless; thread-safe.
#pragma once

#include "core/scene/description.hpp"

namespace tessera::core {

// Removes triangles without area, and those that lie where an earlier one does and face the same way: the
// earlier one is hit, but lights would be counted twice. The others keep their order.
void remove_superfluous_triangles(MeshDescription& mesh);

}  // namespace tessera::core
