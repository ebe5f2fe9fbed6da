// SPDX-License-Identifier: Apache-2.0
#include "core/materials/conductor.hpp"

#include <array>
#include <cstddef>

namespace tessera::core {

ComplexIndex complex_index(Conductor conductor) {
  static constexpr std::array<ComplexIndex, kConductorCount> kFitted{{
      {{0.22f, 1.04f, 1.29f}, {3.375f, 2.620f, 2.358f}},
      {{0.09f, 0.50f, 1.47f}, {13.372f, 2.261f, 1.776f}},
      {{0.055f, 0.055f, 0.045f}, {4.420f, 3.549f, 2.651f}},
      {{1.490f, 0.985f, 0.605f}, {7.625f, 6.548f, 5.346f}},
      {{0.460f, 0.525f, 1.125f}, {4.282f, 2.670f, 1.814f}},
      {{3.250f, 3.115f, 2.285f}, {3.286f, 3.336f, 3.117f}},
      {{2.030f, 1.900f, 1.725f}, {4.198f, 3.568f, 2.894f}},
      {{3.635f, 3.495f, 3.315f}, {2.925f, 2.747f, 2.507f}},
      {{2.050f, 1.520f, 1.025f}, {5.312f, 4.607f, 3.795f}},
      {{1.415f, 1.210f, 1.490f}, {2.971f, 2.026f, 1.252f}},
      {{1.7337f, 1.7409f, 1.7534f}, {}},
      {{2.5733f, 2.6521f, 2.8307f}, {}},
      {{2.8588f, 2.9581f, 3.1869f}, {}},
      {{2.4105f, 2.4238f, 2.4476f}, {}},
      {{1.7788f, 1.7955f, 1.8271f}, {}},
      {{2.6299f, 2.6631f, 2.7241f}, {}},
      {{3.455f, 3.34f, 3.055f}, {3.177f, 3.151f, 3.14f}},
  }};
  return kFitted[static_cast<std::size_t>(conductor)];
}

}  // namespace tessera::core
