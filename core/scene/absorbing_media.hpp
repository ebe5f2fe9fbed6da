// SPDX-License-Identifier: Apache-2.0
// The media inside clear solids that absorb light.
#pragma once

#include <vector>

#include "core/materials/material.hpp"
#include "core/math/rgb.hpp"
#include "core/media/medium_description.hpp"

namespace tessera::core {

// The absorption, for each unit of length, by which light has that colour at that depth above 0 (Beer's law).
Rgb absorption_of(Rgb color, float depth);

// Fills each material that absorbs_inside() and names no media of its own with a medium in which light has
// the transmission colour at the transmission depth (Beer's law). The scene must be valid.
void add_absorbing_media(std::vector<Material>& materials, std::vector<MediumDescription>& media);

}  // namespace tessera::core
