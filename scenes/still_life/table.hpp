// SPDX-License-Identifier: Apache-2.0
// The table, the cloth on it, and the wall behind.
#pragma once

#include "scenes/still_life/model.hpp"

namespace tessera::still_life {

// A board of wood, 160 cm wide; its top is y = 0 and its rounded front edge is at z = 32.
Model table();

// A linen cloth that lies on the table, falls over its edge, and is smooth where scene.json puts things on
// it. In the coordinates of the scene.
Model linen();

// A texture without a mesh, for 4 m by 3 m of wall.
Model plaster();

}  // namespace tessera::still_life
