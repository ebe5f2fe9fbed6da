// SPDX-License-Identifier: Apache-2.0
// A sitting rabbit with its ears up.
#pragma once

#include "core/scene/description.hpp"

namespace tessera::menagerie {

// 20 cm high, in centimetres: it sits on y = 0 and looks along z. Closed, with normals, without uvs; `cube`
// is the size of the marching cubes.
core::MeshDescription rabbit(float cube);

}  // namespace tessera::menagerie
