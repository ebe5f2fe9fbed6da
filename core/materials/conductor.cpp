#include "core/materials/conductor.hpp"

#include <array>
#include <cstddef>

namespace tessera::core {

ComplexIndex complex_index(Conductor conductor) {
  static constexpr std::array<ComplexIndex, 4> kMeasured{{
      {{0.30f, 1.02f, 1.25f}, {3.205f, 2.577f, 2.483f}},
      {{0.21f, 0.43f, 1.31f}, {3.272f, 2.455f, 1.849f}},
      {{0.06f, 0.06f, 0.05f}, {4.152f, 3.586f, 2.869f}},
      {{1.3660f, 1.0728f, 0.7278f}, {7.4052f, 6.7839f, 5.7781f}},
  }};
  return kMeasured[static_cast<std::size_t>(conductor)];
}

}  // namespace tessera::core
