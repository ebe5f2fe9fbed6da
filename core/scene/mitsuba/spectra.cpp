// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mitsuba/spectra.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "core/math/elementary.hpp"
#include "core/scene/mitsuba/parse_values.hpp"
#include "core/spectra/spectrum_color.hpp"

namespace tessera::core::mitsuba {
namespace {

constexpr double kVisibleFromNm = 360, kVisibleToNm = 830;  // of the CIE 1931 observer

std::vector<double> numbers_in(const Plugin& plugin, std::string_view name) {
  return parse_numbers(plugin.text(name).value_or("")).value_or(std::vector<double>());
}

bool grows(const Samples& samples) {
  return std::adjacent_find(samples.begin(), samples.end(), [](const auto& a, const auto& b) {
           return !(a.wavelength_nm < b.wavelength_nm);
         }) == samples.end();
}

// Values at equal distances over a range, which has the names of several versions.
Samples regular_samples(const Plugin& plugin) {
  const std::vector<double> values = numbers_in(plugin, "values"), range = numbers_in(plugin, "range");
  double from = plugin.number("lambda_min", kVisibleFromNm), to = plugin.number("lambda_max", kVisibleToNm);
  from = plugin.number("wavelength_min", from), to = plugin.number("wavelength_max", to);
  if (range.size() == 2) from = range[0], to = range[1];
  Samples samples;
  const double steps = std::max(1.0, static_cast<double>(values.size()) - 1);
  for (std::size_t i = 0; i < values.size(); ++i)
    samples.push_back({from + (to - from) * (static_cast<double>(i) / steps), values[i]});
  return samples;
}

Samples irregular_samples(const Plugin& plugin) {
  const std::vector<double> values = numbers_in(plugin, "values"),
                            wavelengths = numbers_in(plugin, "wavelengths");
  Samples samples;
  for (std::size_t i = 0; values.size() == wavelengths.size() && i < values.size(); ++i)
    samples.push_back({wavelengths[i], values[i]});
  return samples;
}

// In watts per square metre, steradian and nanometre (Planck 1901), every 5 nm.
Samples blackbody_samples(const Plugin& plugin) {
  constexpr double kFirstRadiation = 1.191042972e-16;  // 2 h c^2 in W m^2
  constexpr double kSecondRadiation = 1.438776877e-2;  // h c / k in m K
  constexpr double kMetres = 1e-9, kStepNm = 5, kLargestExponent = 700;
  constexpr double kHottest = 1e9;
  const double kelvin = std::min(plugin.number("temperature", 0), kHottest);
  Samples samples;
  for (double nm = kVisibleFromNm; kelvin > 0 && nm <= kVisibleToNm; nm += kStepNm) {
    const double metres = nm * kMetres, squared = metres * metres;
    const double exponent = kSecondRadiation / (metres * kelvin);
    const double power = exponent > kLargestExponent
                             ? 0
                             : kFirstRadiation / (squared * squared * metres * (core::exp(exponent) - 1));
    samples.push_back({nm, power * kMetres});
  }
  return samples;
}

Rgb not_negative(Rgb c) {
  return {std::max(c.r, 0.0f), std::max(c.g, 0.0f), std::max(c.b, 0.0f)};
}

}  // namespace

Rgb sampled_color(const Samples& samples, bool of_light) {
  if (!of_light) return not_negative(spectra::factor_color(samples));
  return not_negative(spectra::to_linear_rec709(spectra::integrate_to_xyz(samples)));
}

Rgb uniform_light(double power) {
  return spectra::to_linear_rec709({power, power, power});
}

bool is_spectrum_type(std::string_view type) {
  return type == "regular" || type == "irregular" || type == "blackbody";
}

std::optional<Samples> samples_of(const Plugin& plugin) {
  const std::string& type = plugin.type();
  Samples samples = type == "regular"     ? regular_samples(plugin)
                    : type == "irregular" ? irregular_samples(plugin)
                                          : blackbody_samples(plugin);
  if (!samples.empty() && grows(samples)) return samples;
  plugin.warn("has no samples at growing wavelengths");
  return std::nullopt;
}

}  // namespace tessera::core::mitsuba
