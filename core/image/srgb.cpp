// SPDX-License-Identifier: Apache-2.0
#include "core/image/srgb.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/math/elementary.hpp"

namespace tessera::core {
namespace {

double to_linear(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : core::pow((encoded + 0.055) / 1.055, 2.4);
}

// Element k is the smallest float that rounds to code k + 1 or above; encoding counts the elements not
// above a value.
std::array<float, 255> make_thresholds() {
  std::array<float, 255> thresholds{};
  for (int k = 0; k < 255; ++k) {
    const double exact = to_linear((k + 0.5) / 255);
    auto nearest = static_cast<float>(exact);
    if (static_cast<double>(nearest) < exact) {
      nearest = std::nextafter(nearest, std::numeric_limits<float>::infinity());
    }
    thresholds[static_cast<std::size_t>(k)] = nearest;
  }
  return thresholds;
}

std::array<float, 256> make_linear_values() {
  std::array<float, 256> values{};
  for (int code = 0; code < 256; ++code) {
    values[static_cast<std::size_t>(code)] = static_cast<float>(to_linear(code / 255.0));
  }
  return values;
}

}  // namespace

std::uint8_t srgb_encode(float linear) {
  static const std::array<float, 255> thresholds = make_thresholds();
  if (!(linear > 0)) return 0;
  return static_cast<std::uint8_t>(std::upper_bound(thresholds.begin(), thresholds.end(), linear) -
                                   thresholds.begin());
}

float srgb_decode(std::uint8_t code) {
  static const std::array<float, 256> values = make_linear_values();
  return values[code];
}

float srgb_decode(double encoded) {
  return static_cast<float>(to_linear(encoded));
}

}  // namespace tessera::core
