// SPDX-License-Identifier: Apache-2.0
// Colour spaces and chromaticities, converted to linear Rec. 709. Stateless; thread-safe.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "core/math/rgb.hpp"
#include "core/spectra/color_matching.hpp"

namespace tessera::core::spectra {

// Chromaticity coordinates of the CIE 1931 observer.
struct Chromaticity {
  double x = 0, y = 0;
};

// A linear map of colours: three rows.
struct ColorMatrix {
  std::array<std::array<double, 3>, 3> rows{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

  // Negative results become 0: they are colours outside the gamut.
  Rgb operator()(Rgb color) const;
};

// The colour of a light of luminance 1. Channels outside the gamut are 0.
Rgb color_of(Chromaticity chromaticity);

// The standard illuminants of CIE 15:2004 by name: "A", "D50", "D55", "D65", "D75", "F1" to "F12"; and "D60",
// the white of ACES (SMPTE ST 2065-1).
std::optional<Chromaticity> illuminant(std::string_view name);

// Daylight of a correlated colour temperature of 4000 to 25000 K (CIE 15:2004, section 3.1). Temperatures out
// of range are clamped.
Chromaticity daylight(double kelvin);

// Linear colours with other primaries, converted to those of Rec. 709: "srgb", "rec2020", "dci-p3" (with the
// white D65, as Display P3) and "aces2065-1" (white adapted to D65). nullopt for other names.
std::optional<ColorMatrix> to_rec709(std::string_view color_space);

// The primaries and the white of linear colours.
struct Primaries {
  Chromaticity red, green, blue, white;
};

// The same for any primaries, with the white adapted to D65 as by white_balance(). nullopt if they span no
// colours.
std::optional<ColorMatrix> to_rec709(const Primaries& primaries);

// Adapts colours of Rec. 709 seen under the white `from` to D65 (von Kries, with the cone responses of
// Bradford: Lam 1985).
ColorMatrix white_balance(Chromaticity from);

}  // namespace tessera::core::spectra
