// Metals by name, with their measured complex indices of refraction.
#pragma once

#include "core/math/rgb.hpp"

namespace tessera::core {

enum class Conductor { kCopper, kGold, kSilver, kAluminium };

struct ComplexIndex {
  Rgb eta, k;
};

// At the measured wavelengths nearest to the dominant ones of Rec. 709's primaries: 611, 549 and 464 nm.
// Copper, gold and silver: Johnson and Christy 1972, table I, at 2.01, 2.26 and 2.63 eV (617, 549, 471 nm).
// Aluminium: Rakić 1995, table 1, at 2.0, 2.2 and 2.6 eV (620, 564, 477 nm).
ComplexIndex complex_index(Conductor conductor);

}  // namespace tessera::core
