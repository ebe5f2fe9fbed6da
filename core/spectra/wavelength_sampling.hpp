// SPDX-License-Identifier: Apache-2.0
// Wavelengths of white light, for paths that are dispersed in a renderer of red, green and blue. Stateless;
// thread-safe.
#pragma once

#include "core/math/rgb.hpp"

namespace tessera::core::spectra {

struct WavelengthSample {
  float nm = 0;  // 360 to 830
  Rgb weight;    // the colour of light of the wavelength over its density; its components add up to 3
};

// The wavelength for u in [0, 1). Its density is the mean of the responses of red, green and blue to white
// light (D65): the CIE 1931 observer in linear Rec. 709. Where a response is negative, as the wavelength is
// out of gamut, it is 0, and each is then scaled so that the mean of the weights is 1 in each channel.
WavelengthSample sample_wavelength(float u);

}  // namespace tessera::core::spectra
