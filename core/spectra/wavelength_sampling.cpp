// SPDX-License-Identifier: Apache-2.0
#include "core/spectra/wavelength_sampling.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/spectra/color_matching.hpp"
#include "core/spectra/spectrum_color.hpp"

namespace tessera::core::spectra {
namespace {

constexpr int kFirstBinNm = 360, kEndNm = 830;
constexpr std::size_t kBins = kEndNm - kFirstBinNm;  // of 1 nm

using Response = std::array<double, 3>;

// Of the bin of wavelengths that begins at first_nm.
Response response(double first_nm) {
  const double nm = first_nm + 0.5;
  const Xyz matching = color_matching(nm);
  const Rgb color = to_linear_rec709(matching);
  const double power = d65_power(nm);
  return {std::max(0.0f, color.r) * power, std::max(0.0f, color.g) * power, std::max(0.0f, color.b) * power};
}

struct Table {
  std::array<double, kBins + 1> cumulative{};  // the probability of all wavelengths below a bin
  std::array<Rgb, kBins> weights;
};

Table make_table() {
  std::array<Response, kBins> responses;
  Response sums{};
  for (std::size_t i = 0; i < kBins; ++i) {
    responses[i] = response(kFirstBinNm + static_cast<double>(i));
    for (std::size_t c = 0; c < 3; ++c) sums[c] += responses[i][c];
  }
  Table table;
  for (std::size_t i = 0; i < kBins; ++i) {
    Response share;
    for (std::size_t c = 0; c < 3; ++c) share[c] = responses[i][c] / sums[c];
    const double density = (share[0] + share[1] + share[2]) / 3;
    table.cumulative[i + 1] = table.cumulative[i] + density;
    const auto weight = [&](std::size_t c) { return static_cast<float>(share[c] / density); };
    if (density > 0) table.weights[i] = {weight(0), weight(1), weight(2)};
  }
  return table;
}

}  // namespace

WavelengthSample sample_wavelength(float u) {
  static const Table kTable = make_table();
  const auto& cumulative = kTable.cumulative;
  const double total = cumulative.back(), at = static_cast<double>(u) * total;
  const auto above = std::upper_bound(cumulative.begin() + 1, cumulative.end() - 1, at);
  const auto bin = static_cast<std::size_t>(above - cumulative.begin()) - 1;
  const double within = (at - cumulative[bin]) / (cumulative[bin + 1] - cumulative[bin]);
  return {static_cast<float>(kFirstBinNm + static_cast<double>(bin) + within), kTable.weights[bin]};
}

}  // namespace tessera::core::spectra
