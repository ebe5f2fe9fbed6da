// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/temperature.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/math/elementary.hpp"
#include "core/spectra/spectrum_color.hpp"

namespace tessera::core::pbrt {
namespace {

constexpr double kMinTemperature_K = 100, kMaxTemperature_K = 1e6;

// Planck's law, without the factor that all wavelengths share.
double planck(double wavelength_nm, double kelvin) {
  constexpr double kSecondConstant_nmK = 1.438776877e7;
  return pow(wavelength_nm, -5.0) / (exp(kSecondConstant_nmK / (wavelength_nm * kelvin)) - 1);
}

Rgb black_body(double kelvin) {
  constexpr double kWien_nmK = 2.897771955e6;
  const double brightest = planck(kWien_nmK / kelvin, kelvin);
  std::vector<spectra::SpectralSample> spectrum;
  for (int nm = 360; nm <= 830; nm += 10)
    spectrum.push_back({static_cast<double>(nm), planck(nm, kelvin) / brightest});
  return spectra::blackbody_color(kelvin) * static_cast<float>(spectra::photopic_mean(spectrum));
}

// Black bodies by the logarithm of the temperature.
class ColorTable {
 public:
  ColorTable() {
    for (std::size_t i = 0; i < colors_.size(); ++i)
      colors_[i] = black_body(kMinTemperature_K *
                              pow(kMaxTemperature_K / kMinTemperature_K, static_cast<double>(i) / kSteps));
  }

  Rgb at(float kelvin) const {
    if (!(kelvin > kMinTemperature_K)) return {};
    static const double kRange = log(kMaxTemperature_K / kMinTemperature_K);
    const double at = std::min(log(static_cast<double>(kelvin) / kMinTemperature_K) / kRange, 1.0) * kSteps;
    const auto below = std::min(static_cast<std::size_t>(at), colors_.size() - 2);
    const auto share = static_cast<float>(at - static_cast<double>(below));
    return colors_[below] * (1 - share) + colors_[below + 1] * share;
  }

 private:
  static constexpr int kSteps = 1024;
  std::array<Rgb, kSteps + 1> colors_;
};

}  // namespace

VoxelGrid black_bodies(const VoxelGrid& temperatures, const TemperatureUnits& units) {
  const ColorTable table;
  VoxelGrid colors{.size = temperatures.size, .channels = 3, .border = temperatures.border};
  colors.values.reserve(3 * temperatures.values.size());
  for (const float value : temperatures.values) {
    const Rgb color = table.at((value - units.offset) * units.scale);
    for (int channel = 0; channel < 3; ++channel) colors.values.push_back(std::max(color[channel], 0.0f));
  }
  return colors;
}

}  // namespace tessera::core::pbrt
