// SPDX-License-Identifier: Apache-2.0
// Vessels turned on a wheel, and a blown glass.
#pragma once

#include "scenes/still_life/model.hpp"

namespace tessera::still_life {

// 31 cm high, stoneware dipped upside down into a white glaze. Closed.
Model stoneware_bottle();

// 8 cm high and 22 cm wide, speckled, with the ridges of the thrower's fingers. Closed.
Model speckled_bowl();

// 18 cm high, clear glass of the thickness of real ones. Closed, no texture.
Model goblet();

}  // namespace tessera::still_life
