// SPDX-License-Identifier: Apache-2.0
// An OBJ file for measuring: a bumpy square sheet of triangles, written as exporters do, with six decimals.
#pragma once

#include <string>

namespace tessera::bench {

enum class GridData { kPositions, kUvsAndNormals };

// At least `triangles` of them, in rows of equal length.
std::string grid_obj(int triangles, GridData data);

}  // namespace tessera::bench
