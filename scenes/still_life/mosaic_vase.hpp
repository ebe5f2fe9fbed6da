// SPDX-License-Identifier: Apache-2.0
// A vase covered with a mosaic: small stones set in mortar by hand, some of them gold.
#pragma once

#include "scenes/still_life/model.hpp"

namespace tessera::still_life {

// 28 cm high. Materials "stone" (textured) and "gold". Closed.
Model mosaic_vase();

}  // namespace tessera::still_life
