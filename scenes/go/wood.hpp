// SPDX-License-Identifier: Apache-2.0
// Wood as a solid: what is cut from it shows its grain on every side. Positions are in centimetres.
#pragma once

#include "core/math/rgb.hpp"
#include "core/math/vec3.hpp"

namespace tessera::go {

// Old kaya cut from the quarter: straight, fine rings seen as lines along z on the top, as wide bands on the
// sides.
struct Kaya {
  core::Rgb color;
  float relief;  // how far late wood and fibres stand out when it is planed, in centimetres
};
Kaya kaya(core::Vec3 p);

// Mulberry, turned and oiled, of which bowls are made; the trunk's axis is x.
core::Rgb mulberry(core::Vec3 p);

// Walnut, stained nearly black; planks along x.
core::Rgb walnut(core::Vec3 p);

}  // namespace tessera::go
