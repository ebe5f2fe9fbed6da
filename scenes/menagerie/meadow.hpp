// SPDX-License-Identifier: Apache-2.0
// Grass and daisies around the animals.
#pragma once

#include "core/image/image.hpp"
#include "core/scene/description.hpp"

namespace tessera::menagerie {

// Blades and flowers in the coordinates of the scene, growing from y = 0, parted where scene.json puts the
// animals. Open surfaces, to be seen from both sides.
core::MeshDescription meadow();

// For the uvs of meadow(): shades of green from left to right, roots to tips upwards; the right edge is for
// flowers.
core::Image meadow_colors();

// The ground between the blades, for a square of 40 cm that repeats.
core::Image ground_colors();

}  // namespace tessera::menagerie
