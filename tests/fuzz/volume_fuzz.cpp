// SPDX-License-Identifier: Apache-2.0
// A grid volume: refused, or a grid that a medium can have.
#include <limits>

#include "core/media/voxel_grid.hpp"
#include "core/scene/loader/volume_reader.hpp"
#include "tests/fuzz/expect.hpp"
#include "tests/fuzz/fuzzer.hpp"

namespace tessera::fuzz {

TESSERA_FUZZER(volume, std::string_view input) {
  auto grid = core::read_volume(input);
  if (!grid) return;
  expect(core::is_sound(*grid), "the grid is sound");
  const core::Rgb value = core::value_at(*grid, {0.3f, 0.6f, 1});
  const core::Rgb bound = core::bound_in(*grid, {0, 0, 0}, {1, 1, 1});
  // Denormal numbers are rounded to few digits.
  const auto holds = [](float v, float most) {
    return v <= most * 1.0001f + std::numeric_limits<float>::min();
  };
  expect(holds(value.r, bound.r) && holds(value.g, bound.g) && holds(value.b, bound.b), "the bound holds");
}

}  // namespace tessera::fuzz
