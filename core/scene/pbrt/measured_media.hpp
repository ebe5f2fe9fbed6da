// SPDX-License-Identifier: Apache-2.0
// Measured coefficients of media by the names that pbrt has for them. Stateless; thread-safe.
#pragma once

#include <string_view>

#include "core/math/rgb.hpp"

namespace tessera::core::pbrt {

struct MeasuredMedium {
  std::string_view name;
  Rgb sigma_s, sigma_a;  // reduced scattering, and absorption, per millimetre
};

// Null for an unknown name.
const MeasuredMedium* find_measured_medium(std::string_view name);

}  // namespace tessera::core::pbrt
