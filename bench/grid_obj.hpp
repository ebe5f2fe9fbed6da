// SPDX-License-Identifier: Apache-2.0
// Generates an OBJ file for benchmarks: a bumpy square sheet of triangles, with six decimals as exporters
// write.
#pragma once

#include <string>

namespace tessera::bench {

enum class GridData { kPositions, kUvsAndNormals };

// At least `triangles` of them, in rows of equal length.
std::string grid_obj(int triangles, GridData data);

}  // namespace tessera::bench
