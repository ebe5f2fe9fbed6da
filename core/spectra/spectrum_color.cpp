// SPDX-License-Identifier: Apache-2.0
#include "core/spectra/spectrum_color.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "core/math/elementary.hpp"

namespace tessera::core::spectra {
namespace {

constexpr double kVisibleFromNm = 360, kVisibleToNm = 830;

// The power of illuminant D65 (ISO/CIE 11664-2), from 360 to 830 nm in steps of 10 nm.
constexpr double kD65StepNm = 10;
constexpr std::array<double, 48> kD65Power{
    46.6383, 52.0891, 49.9755, 54.6482, 82.7549, 91.486,  93.4318, 86.6823, 104.865, 117.008,
    117.812, 114.861, 115.923, 108.811, 109.354, 107.802, 104.79,  107.689, 104.405, 104.046,
    100,     96.3342, 95.788,  88.6856, 90.0062, 89.5991, 87.6987, 83.2886, 83.6992, 80.0268,
    80.2146, 82.2778, 78.2842, 69.7213, 71.6091, 74.349,  61.604,  69.8856, 75.087,  63.5927,
    46.4182, 66.8054, 63.3828, 64.304,  59.4519, 51.959,  57.4406, 60.3125};

Rgb clipped(Rgb color) {
  return {std::max(color.r, 0.0f), std::max(color.g, 0.0f), std::max(color.b, 0.0f)};
}

Rgb relative_to(const Xyz& color, double luminance) {
  if (!(luminance > 0)) return {};
  return clipped(to_linear_rec709({color.x / luminance, color.y / luminance, color.z / luminance}));
}

// A spectrum of value(nm), every nanometre.
template <typename Value>
std::vector<SpectralSample> visible_spectrum(const Value& value) {
  std::vector<SpectralSample> samples;
  for (double nm = kVisibleFromNm; nm <= kVisibleToNm; ++nm) samples.push_back({nm, value(nm)});
  return samples;
}

double planck(double nm, double kelvin) {
  constexpr double kSecondRadiation = 1.438776877e7;  // h c / k in nm K
  const double exponent = kSecondRadiation / (nm * kelvin);
  if (exponent > 700) return 0;
  const double reach = nm / 560;
  return 1 / (reach * reach * reach * reach * reach * (exp(exponent) - 1));
}

}  // namespace

double d65_power(double nm) {
  const double at = (nm - kVisibleFromNm) / kD65StepNm;
  const std::size_t i = std::min(static_cast<std::size_t>(at), kD65Power.size() - 2);
  return kD65Power[i] + (kD65Power[i + 1] - kD65Power[i]) * (at - static_cast<double>(i));
}

Rgb light_color(std::span<const SpectralSample> power) {
  const Xyz sum = integrate_to_xyz(power);
  return relative_to(sum, sum.y);
}

Rgb factor_color(std::span<const SpectralSample> factor) {
  const Xyz lit =
      integrate_to_xyz(visible_spectrum([&](double nm) { return value_at(factor, nm) * d65_power(nm); }));
  const Xyz white = integrate_to_xyz(visible_spectrum(d65_power));
  const Rgb color = relative_to(lit, white.y), all = relative_to(white, white.y);
  return {color.r / all.r, color.g / all.g, color.b / all.b};
}

double photopic_mean(std::span<const SpectralSample> spectrum) {
  double sum = 0, weights = 0;
  for (double nm = kVisibleFromNm; nm <= kVisibleToNm; ++nm) {
    if (spectrum.empty() || nm < spectrum.front().wavelength_nm || nm > spectrum.back().wavelength_nm)
      continue;
    const double weight = color_matching(nm).y;
    sum += weight * value_at(spectrum, nm), weights += weight;
  }
  return weights > 0 ? sum / weights : 0;
}

Rgb blackbody_color(double kelvin) {
  return light_color(visible_spectrum([&](double nm) { return planck(nm, kelvin); }));
}

}  // namespace tessera::core::spectra
