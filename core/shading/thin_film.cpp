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
  double transformed(double phase, double shift) const {
    return weight * std::sqrt(2 * static_cast<double>(kPi) * variance) *
           static_cast<double>(cos(static_cast<float>(mean * phase + shift))) *
           exp(-variance * phase * phase);
  }
};

// The observer's response to the interference of waves that differ by a length and a phase, in Rec. 709.
Rgb response(float difference_nm, float shift) {
  constexpr Gaussian kX{5.4856e-13, 1.6810e6, 4.3278e9}, kX2{9.7470e-14, 2.2399e6, 4.5282e9},
      kY{4.4201e-13, 1.7953e6, 9.3046e9}, kZ{5.2481e-13, 2.2084e6, 6.6121e9};
  constexpr double kNormalization = 1.0685e-7;
  const double phase = 2 * static_cast<double>(kPi) * static_cast<double>(difference_nm) * 1e-9;
  const auto s = static_cast<double>(shift);
  const auto x = static_cast<float>((kX.transformed(phase, s) + kX2.transformed(phase, s)) / kNormalization);
  const auto y = static_cast<float>(kY.transformed(phase, s) / kNormalization);
  const auto z = static_cast<float>(kZ.transformed(phase, s) / kNormalization);
  return {3.2404542f * x - 1.5371385f * y - 0.4985314f * z, -0.9692660f * x + 1.8760108f * y + 0.0415560f * z,
          0.0556434f * x - 0.2040259f * y + 1.0572252f * z};
}

// response() of a channel; index 0 is red.
template <typename T>
T response_of(int channel, T difference_nm, T shift) {
  return in_each_lane([channel](float d, float s) { return response(d, s)[channel]; }, difference_nm, shift);
}

template <typename T>
T schlick(T cos_i, T f0) {
  return fresnel_schlick(cos_i, RgbOf<T>::gray(f0)).r;
}

template <typename T>
T index_of(T f0) {
  using std::sqrt;
  const T r = sqrt(smaller(f0, T(0.9999f)));
  return (1 + r) / (1 - r);
}

// Films thinner than 30 nm fade away.
template <typename T>
T fade_in(T thickness_nm) {
  const T t = smaller(T(1.0f), thickness_nm / 30);
  return t * t * (3 - 2 * t);
}

}  // namespace

template <typename T>
FilmReflectanceOf<T>::FilmReflectanceOf(RgbOf<T> f0, T weight, T film_ior, T thickness)
    : f0_(f0),
      base_ior_{index_of(f0.r), index_of(f0.g), index_of(f0.b)},
      weight_(weight),
      film_ior_(1 + (film_ior - 1) * fade_in(1000 * thickness)),
      thickness_nm_(smaller(1000 * thickness, T(1e4f))) {}

template <typename T>
RgbOf<T> FilmReflectanceOf<T>::operator()(T cos_i) const {
  const RgbOf<T> bare = fresnel_schlick(cos_i, f0_);
  return bare + (covered(cos_i) - bare) * weight_;
}

// Reflections between the film's two sides, summed as a series of which two interfering terms are kept
// (ibid., eq. 10).
template <typename T>
RgbOf<T> FilmReflectanceOf<T>::covered(T cos_i) const {
  using std::sqrt;
  const T sin2 = (1 - cos_i * cos_i) / (film_ior_ * film_ior_);
  const T cos_t = sqrt(larger(T(0.0f), 1 - sin2));
  const T upper = schlick(cos_i, normal_reflectance(film_ior_)), through = 1 - upper;
  const T difference = 2 * film_ior_ * thickness_nm_ * cos_t;
  const auto channel = [&](T base_ior, int index) {
    const T lower = schlick(cos_t, normal_reflectance(base_ior / film_ior_));
    const T both = upper * lower, amplitude = sqrt(both);
    const T constant = through * through * lower / (1 - both);
    // Reflection at the denser side turns the phase by half a turn.
    const T shift = select(base_ior < film_ior_, T(2 * kPi), T(kPi));
    T order = constant - through, sum = upper + constant;
    for (int m = 1; m <= 2; ++m) {
      const auto times = static_cast<float>(m);
      order = order * amplitude;
      sum = sum + order * 2 * response_of(index, T(times * difference), T(times * shift));
    }
    return clamp_between(sum, 0.0f, 1.0f);
  };
  const RgbOf<T> inside{channel(base_ior_.r, 0), channel(base_ior_.g, 1), channel(base_ior_.b, 2)};
  return select(sin2 >= 1, RgbOf<T>::gray(1), inside);
}

template class FilmReflectanceOf<float>;
template class FilmReflectanceOf<FloatN>;

}  // namespace tessera::core::shading
