// SPDX-License-Identifier: Apache-2.0
// How images and grids are read beyond their edges, and between their texels or voxels.
#pragma once

namespace tessera::core {

// Beyond the edges: the grid or image again, its edge, or itself mirrored at each edge.
enum class Wrap { kRepeat, kClamp, kMirror };
// Between texels or voxels: interpolated, or the nearest one's value.
enum class TextureFilter { kLinear, kNearest };

}  // namespace tessera::core
