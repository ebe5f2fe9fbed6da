// SPDX-License-Identifier: Apache-2.0
// A grid volume: refused, or a grid that a medium can have.
#include "core/media/voxel_grid.hpp"
#include "core/scene/loader/volume_reader.hpp"
#include "tests/fuzz/expect.hpp"
#include "tests/fuzz/parts.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tessera;
  auto grid = core::read_volume(fuzz::as_text(data, size));
  if (!grid) return 0;
  fuzz::expect(core::is_sound(*grid), "the grid is sound");
  const core::Rgb value = core::value_at(*grid, {0.3f, 0.6f, 1});
  const core::Rgb bound = core::bound_in(*grid, {0, 0, 0}, {1, 1, 1});
  fuzz::expect(value.r <= bound.r * 1.0001f && value.b <= bound.b * 1.0001f, "the bound holds");
  return 0;
}
