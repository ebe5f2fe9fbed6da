// SPDX-License-Identifier: Apache-2.0
#include "core/materials/hair.hpp"

#include <algorithm>
#include <cmath>

namespace tessera::core {

Rgb hair_color(Rgb absorption, float beta_n) {
  const double scale = hair_multiple_scattering(beta_n);
  const auto channel = [scale](float a) {
    return static_cast<float>(exp(-scale * std::sqrt(std::max(static_cast<double>(a), 0.0))));
  };
  return {channel(absorption.r), channel(absorption.g), channel(absorption.b)};
}

}  // namespace tessera::core
