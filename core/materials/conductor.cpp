// SPDX-License-Identifier: Apache-2.0
#include "core/materials/conductor.hpp"

#include <array>
#include <cstddef>

namespace tessera::core {

ComplexIndex complex_index(Conductor conductor) {
  static constexpr std::array<ComplexIndex, 4> kFitted{{
      {{0.22f, 1.04f, 1.29f}, {3.375f, 2.620f, 2.358f}},
      {{0.09f, 0.50f, 1.47f}, {13.372f, 2.261f, 1.776f}},
      {{0.055f, 0.055f, 0.045f}, {4.420f, 3.549f, 2.651f}},
      {{1.490f, 0.985f, 0.605f}, {7.625f, 6.548f, 5.346f}},
  }};
  return kFitted[static_cast<std::size_t>(conductor)];
}

}  // namespace tessera::core
