// SPDX-License-Identifier: Apache-2.0
#include "core/shading/thin_film.hpp"

#include <cmath>

#include "core/materials/fresnel.hpp"
#include "core/math/elementary.hpp"
#include "core/math/lane_array.hpp"

namespace tessera::core::shading {
namespace {

// A Gaussian that approximates a sensitivity over the wavenumber: its weight, mean and variance, for lengths
// in metres (Belcour and Barla 2017, supplemental material).
struct Gaussian {
  double weight, mean, variance;

  // The real part of its Fourier transform.
  double transformed(double phase) const {
    return weight * std::sqrt(2 * static_cast<double>(kPi) * variance) *
           static_cast<double>(cos(static_cast<float>(mean * phase))) * exp(-variance * phase * phase);
  }
};

// The observer's response to the interference of waves that differ by a length, in Rec. 709.
Rgb response(float difference_nm) {
  constexpr Gaussian kX{5.4856e-13, 1.6810e6, 4.3278e9}, kX2{9.7470e-14, 2.2399e6, 4.5282e9},
      kY{4.4201e-13, 1.7953e6, 9.3046e9}, kZ{5.2481e-13, 2.2084e6, 6.6121e9};
  constexpr double kNormalization = 1.0685e-7;
  const double phase = 2 * static_cast<double>(kPi) * static_cast<double>(difference_nm) * 1e-9;
  const auto x = static_cast<float>((kX.transformed(phase) + kX2.transformed(phase)) / kNormalization);
  const auto y = static_cast<float>(kY.transformed(phase) / kNormalization);
  const auto z = static_cast<float>(kZ.transformed(phase) / kNormalization);
  return {3.2404542f * x - 1.5371385f * y - 0.4985314f * z, -0.9692660f * x + 1.8760108f * y + 0.0415560f * z,
          0.0556434f * x - 0.2040259f * y + 1.0572252f * z};
}
RgbOf<FloatN> response(FloatN difference_nm) {
  const FloatLanes differences(difference_nm);
  RgbLanes responses;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) responses.set(lane, response(differences[lane]));
  return responses.all();
}

// The amplitudes that a boundary reflects of light polarised across and along the plane of incidence (Born
// and Wolf 1999, section 1.5.2, eq. 21), by the index on the far side over the near side.
template <typename T>
struct Amplitudes {
  Amplitudes(T cos_i, T cos_t, T eta)
      : across((cos_i - eta * cos_t) / (cos_i + eta * cos_t)),
        along((eta * cos_i - cos_t) / (eta * cos_i + cos_t)) {}
  T across, along;
};

// The cosine below a boundary to the index `ior`, at least 1, from air.
template <typename T>
T cos_below(T cos_i, T ior) {
  using std::sqrt;
  return sqrt((ior - 1) * (ior + 1) + cos_i * cos_i) / ior;
}

// Reflections between the film's two sides, summed as a series of which two interfering terms are kept
// (Belcour and Barla 2017, eq. 10), for one polarisation. The responses are those to once and twice the
// film's path.
template <typename T>
T interfering(T upper_amplitude, T lower_amplitude, T once, T twice) {
  const T upper = upper_amplitude * upper_amplitude, lower = lower_amplitude * lower_amplitude;
  const T through = 1 - upper;
  const T constant = through * through * lower / (1 - upper * lower);
  const T amplitude = -upper_amplitude * lower_amplitude;  // from inside, the upper side turns the phase
  return upper + constant + 2 * (constant - through) * amplitude * (once + amplitude * twice);
}

template <typename T>
T index_of(T f0) {
  using std::sqrt;
  const T r = sqrt(smaller(f0, T(0.9999f)));
  return (1 + r) / (1 - r);
}

constexpr float kMinCos = 1e-4f;  // at grazing angles, where everything reflects, there is no film

// Films thinner than 30 nm fade away.
template <typename T>
T fade_in(T thickness_nm) {
  const T t = smaller(T(1.0f), thickness_nm / 30);
  return t * t * (3 - 2 * t);
}

}  // namespace

template <typename T>
ThinFilmOf<T>::ThinFilmOf(RgbOf<T> f0, T weight, T film_ior, T thickness)
    : base_ior_{index_of(f0.r), index_of(f0.g), index_of(f0.b)},
      weight_(weight),
      film_ior_(1 + (film_ior - 1) * fade_in(1000 * thickness)),
      thickness_nm_(smaller(1000 * thickness, T(1e4f))) {}

template <typename T>
RgbOf<T> ThinFilmOf<T>::change(T cos_i) const {
  cos_i = clamp_between(cos_i, kMinCos, 1.0f);
  const T cos_film = cos_below(cos_i, film_ior_);
  const Amplitudes<T> upper(cos_i, cos_film, film_ior_);
  const T difference = 2 * film_ior_ * thickness_nm_ * cos_film;
  const RgbOf<T> once = response(difference), twice = response(2 * difference);
  const auto channel = [&](T base_ior, T once_of_it, T twice_of_it) {
    const Amplitudes<T> lower(cos_film, cos_below(cos_i, base_ior), base_ior / film_ior_);
    const T across = interfering(upper.across, lower.across, once_of_it, twice_of_it);
    const T along = interfering(upper.along, lower.along, once_of_it, twice_of_it);
    return weight_ * ((across + along) / 2 - fresnel_dielectric<T>(cos_i, base_ior));
  };
  return {channel(base_ior_.r, once.r, twice.r), channel(base_ior_.g, once.g, twice.g),
          channel(base_ior_.b, once.b, twice.b)};
}

template class ThinFilmOf<float>;
template class ThinFilmOf<FloatN>;

}  // namespace tessera::core::shading
