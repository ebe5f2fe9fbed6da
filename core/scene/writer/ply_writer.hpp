// SPDX-License-Identifier: Apache-2.0
// Writes meshes as PLY files. Stateless; thread-safe.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/scene/description.hpp"

namespace tessera::core {

// A little-endian binary file with all bits of the mesh, which read_ply() reads back. `materials` is the
// "material_index" of each triangle; empty for none.
std::string write_ply(const MeshDescription& mesh, const std::vector<std::uint32_t>& materials);

}  // namespace tessera::core
