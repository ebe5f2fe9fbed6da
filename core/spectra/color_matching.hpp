// SPDX-License-Identifier: Apache-2.0
// From spectra to colours, by the CIE 1931 standard observer (2 degrees). Stateless; thread-safe.
#pragma once

#include <span>

#include "core/math/rgb.hpp"

namespace tessera::core::spectra {

// A colour of CIE 1931.
struct Xyz {
  double x = 0, y = 0, z = 0;
};

// A spectrum's value at a wavelength.
struct SpectralSample {
  double wavelength_nm = 0;
  double value = 0;
};

// The colour matching functions, linear between the 5 nm of their table; 0 outside of 360 to 830 nm.
Xyz color_matching(double wavelength_nm);

// The value of a spectrum, whose samples are in the order of strictly growing wavelengths; it is linear
// between them and 0 outside of them.
double value_at(std::span<const SpectralSample> samples, double wavelength_nm);

// The integral of a spectrum times the colour matching functions, divided by the integral of the second one:
// a spectrum of 1 everywhere has the luminance 1. `samples` are in the order of strictly growing wavelengths;
// the spectrum is linear between them and 0 outside of them.
Xyz integrate_to_xyz(std::span<const SpectralSample> samples);

// Linear Rec. 709 with its white point D65 (ITU-R BT.709-6, inverted). Colours out of gamut have negative
// components.
Rgb to_linear_rec709(const Xyz& color);

}  // namespace tessera::core::spectra
