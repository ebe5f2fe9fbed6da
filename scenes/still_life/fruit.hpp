// SPDX-License-Identifier: Apache-2.0
// Fruit: turned shapes that are then made uneven, with painted skins.
#pragma once

#include "scenes/still_life/model.hpp"

namespace tessera::still_life {

// About 7.5 cm across. Closed.
Model orange();

// About 9 cm long, lying along the x axis. Closed.
Model lemon();

// About 11 cm high with its stem, leaning a little. Closed: the fruit and the stem each by itself.
Model pear();

}  // namespace tessera::still_life
