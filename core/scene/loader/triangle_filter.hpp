// SPDX-License-Identifier: Apache-2.0
// Removes redundant triangles from a mesh. Stateless; thread-safe.
#pragma once

#include <cstddef>

#include "core/scene/description.hpp"

namespace tessera::core {

// Removes triangles without area, and those that coincide with an earlier one facing the same way: rays hit
// the earlier one, but as lights both would count. The others keep their order. Returns the number of those
// without area.
std::size_t remove_superfluous_triangles(MeshDescription& mesh);

}  // namespace tessera::core
