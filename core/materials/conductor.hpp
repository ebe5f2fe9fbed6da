// SPDX-License-Identifier: Apache-2.0
// Metals, and other crystals of which renderers make mirrors, by name, with complex indices of refraction
// fitted to their measured colours.
#pragma once

#include <cstddef>

#include "core/math/rgb.hpp"

namespace tessera::core {

enum class Conductor {
  kCopper,
  kGold,
  kSilver,
  kAluminium,
  kBrass,
  kChromium,
  kNickel,
  kTungsten,
  kMercury,
  kTitaniumNitride,
  kMagnesiumOxide,
  kTitaniumDioxide,
  kTitaniumDioxideExtraordinary,
  kDiamond,
  kCaesiumIodide,
  kSiliconCarbide,
  kBeryllium,
};
inline constexpr std::size_t kConductorCount = 17;

struct ComplexIndex {
  Rgb eta, k;
};

// One index for each channel of linear Rec. 709, fitted to the measured reflectance under illuminant D65,
// integrated over the spectrum: exact at normal incidence, and within 0.005 at other angles. Copper, gold
// and silver: Johnson and Christy 1972, table I. Aluminium: Rakić 1995, table 1. Brass: Querry 1985.
// Chromium and nickel: Johnson and Christy 1974. Tungsten: Weaver, Olson and Lynch 1975. Mercury: Inagaki,
// Arakawa and Williams 1981. Titanium nitride: Pflüger et al. 1984. Beryllium: the Lorentz-Drude
// model of Rakić et al. 1998. The others do not absorb and follow dispersion formulas: magnesium oxide,
// Stephens and Malitson 1952; rutile, DeVore 1951; diamond, Peter 1923; caesium iodide, Li 1976; silicon
// carbide (6H, ordinary ray), Singh et al. 1971. Gold reflects 1.04 of white's red; here
// it is 0.998.
ComplexIndex complex_index(Conductor conductor);

}  // namespace tessera::core
