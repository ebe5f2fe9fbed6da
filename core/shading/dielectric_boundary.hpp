// SPDX-License-Identifier: Apache-2.0
// What a dielectric boundary does to light of a path, with or without a wavelength. T is float for one point,
// or FloatN for one in each lane.
#pragma once

#include "core/materials/dispersion.hpp"

namespace tessera::core::shading {

template <typename T>
struct DielectricBoundaryOf {
  DielectricBoundaryOf() = default;
  // `index` is that of the inside, relative to the outside.
  DielectricBoundaryOf(T index, MaskOf<T> viewed_from_outside, RgbOf<T> reflected, RgbOf<T> transmitted)
      : eta(select(viewed_from_outside, index, 1 / index)),
        fresnel_eta(eta),
        reflectance(reflected),
        transmittance(transmitted) {}

  // Refracts light by its wavelength. If that is open, what is refracted has its colour. What the thinner
  // side reflects is then by the index at line d, and has none. On the denser side wavelengths differ in
  // total reflection, so that reflection has it, too. Reflectance and transmittance add up to 1 in the mean.
  void disperse(const WavelengthOf<T>& light, T index, MaskOf<T> viewed_from_outside, T inverse_abbe_number) {
    const MaskOf<T> disperses = inverse_abbe_number != 0;
    if (!any(disperses)) return;
    const T n = dispersed_index(index, inverse_abbe_number, cauchy_abscissa(light.nm));
    const T dispersed = select(viewed_from_outside, n, 1 / n);
    const MaskOf<T> open = disperses & light.open, thinner = eta > 1, open_and_thinner = open & thinner;
    const MaskOf<T> by_line_d = open_and_thinner | !disperses, colored = open & !thinner;
    fresnel_eta = select(by_line_d, eta, dispersed);
    eta = select(disperses, dispersed, eta);
    reflectance = select(colored, reflectance * light.weight, reflectance);
    transmittance = select(open, transmittance * light.weight, transmittance);
  }

  T eta{};                              // of the far side over the near side
  T fresnel_eta{};                      // the same for the reflectance
  RgbOf<T> reflectance, transmittance;  // tints
};

}  // namespace tessera::core::shading
