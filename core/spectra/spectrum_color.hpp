// SPDX-License-Identifier: Apache-2.0
// The colours in linear Rec. 709 of spectra, for scenes that give lights and surfaces by wavelengths. The
// samples of a spectrum are in the order of strictly growing wavelengths; it is linear between them and 0
// outside of them. Channels of colours outside the gamut are 0. Stateless; thread-safe.
#pragma once

#include <span>

#include "core/math/rgb.hpp"
#include "core/spectra/color_matching.hpp"

namespace tessera::core::spectra {

// The colour of light with this spectral power, scaled to luminance 1; black without visible power.
Rgb light_color(std::span<const SpectralSample> power);

// The colour of a surface with this reflectance, or of any factor, under illuminant D65: a factor that is
// the same at all wavelengths is a gray of that value.
Rgb factor_color(std::span<const SpectralSample> factor);

// The mean, weighted by the luminous efficiency, over the wavelengths of the samples: of an index of
// refraction.
double photopic_mean(std::span<const SpectralSample> spectrum);

// The relative power of illuminant D65 at a wavelength from 360 to 830 nm (ISO/CIE 11664-2).
double d65_power(double wavelength_nm);

// The colour of a black body, scaled to luminance 1 (Planck 1901). `kelvin` is above 0.
Rgb blackbody_color(double kelvin);

}  // namespace tessera::core::spectra
