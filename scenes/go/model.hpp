// SPDX-License-Identifier: Apache-2.0
// A part of the go scene: its mesh and its textures. Lengths are in centimetres, y is up, the top of the
// board is y = 0 and its middle the origin.
#pragma once

#include "core/image/image.hpp"
#include "core/scene/description.hpp"

namespace tessera::go {

// How far below the board's top the table is.
inline constexpr float kBoardHeight = 4;

struct Model {
  core::MeshDescription mesh;  // empty for a texture by itself
  core::Image color;           // of no pixels where it needs none
  core::Image normals;         // a tangent-space normal map in linear bytes, or of no pixels
};

}  // namespace tessera::go
