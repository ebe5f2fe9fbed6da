// SPDX-License-Identifier: Apache-2.0
// A small cow, brown and white.
#pragma once

#include "core/image/image.hpp"
#include "core/scene/description.hpp"

namespace tessera::menagerie {

// 19 cm high, in centimetres: it stands on y = 0 and looks along z. Closed, with normals and uvs; `cube` is
// the size of the marching cubes.
core::MeshDescription cow(float cube, int texture_px);

// The coat, for the uvs of `cow(..., texture_px)`.
core::Image cow_coat(const core::MeshDescription& cow, int texture_px);

}  // namespace tessera::menagerie
