// SPDX-License-Identifier: Apache-2.0
// Dispersion: how the index of refraction of a dielectric depends on the wavelength. Cauchy's formula with
// two terms, n = A + B / λ² (Born and Wolf 1999, section 2.3.4), from the index n_d and the Abbe number V_d =
// (n_d - 1) / (n_F - n_C) at Fraunhofer's lines C, d and F. T is float, or FloatN for one in each lane.
#pragma once

#include <cmath>

#include "core/materials/limits.hpp"
#include "core/math/rgb.hpp"

namespace tessera::core {

// Fraunhofer's lines of hydrogen (C and F) and of helium (d), in nm.
inline constexpr double kLineC = 656.27, kLineD = 587.56, kLineF = 486.13;

inline constexpr float kMaxDispersionScale = 100, kMinAbbeNumber = 1, kMaxAbbeNumber = 1000;

// As OpenPBR 1.1 has it: the Abbe number is abbe_number / scale, and a scale of 0 is none.
struct Dispersion {
  float scale = 0;
  float abbe_number = 20;

  float inverse_abbe_number() const { return scale / abbe_number; }
};

// The place of a wavelength in Cauchy's formula: 0 at line d, and greater by 1 at line F than at line C.
template <typename T>
T cauchy_abscissa(T wavelength_nm) {
  constexpr double kF = (kLineD / kLineF) * (kLineD / kLineF), kC = (kLineD / kLineC) * (kLineD / kLineC);
  constexpr auto kScale = static_cast<float>(1 / (kF - kC));
  const T ratio = static_cast<float>(kLineD) / wavelength_nm;
  return (ratio * ratio - 1) * kScale;
}

// The index at an abscissa, on the side of 1 where that of line d is. One close to 1 is the same everywhere.
template <typename T>
T dispersed_index(T index_d, T inverse_abbe_number, T abscissa) {
  using std::fabs;
  constexpr float kMinDispersedBending = 2 * kMinBending;
  const T index = index_d + (index_d - 1) * inverse_abbe_number * abscissa;
  const T bounded = select(index_d > 1, clamp_between(index, 1 + kMinDispersedBending, kMaxIor),
                           clamp_between(index, kMinRelativeIor, 1 - kMinDispersedBending));
  return select(fabs(index_d - 1) < kMinDispersedBending, index_d, bounded);
}

// Light at a vertex where it may be dispersed. A path has light of all wavelengths until a dispersive
// boundary refracts it; from there on it has the wavelength that was chosen at that vertex.
template <typename T>
struct WavelengthOf {
  T nm;
  MaskOf<T> open;   // chosen for this vertex; else it is that of the path
  RgbOf<T> weight;  // of light of an open wavelength: 1 in the mean
};
using Wavelength = WavelengthOf<float>;

// The wavelength of the path that goes on from the vertex, 0 for all. `refracted`: by a dispersive boundary.
template <typename T>
T wavelength_beyond(const WavelengthOf<T>& light, MaskOf<T> refracted) {
  const MaskOf<T> still_open = light.open & !refracted;
  return select(still_open, T(0.0f), light.nm);
}

}  // namespace tessera::core
