// SPDX-License-Identifier: Apache-2.0
// A NanoVDB file, and a sound grid in which the input changes values: pairs of an offset in 4 bytes and a
// value in 8. A grid takes 307 KB, of which most bytes do not matter.
#include <cstdint>
#include <cstring>
#include <string>

#include "core/scene/loader/nanovdb_file.hpp"
#include "core/scene/loader/nanovdb_grid.hpp"
#include "tests/fuzz/expect.hpp"
#include "tests/fuzz/fuzzer.hpp"
#include "tests/support/nanovdb_bytes.hpp"

namespace tessera::fuzz {

TESSERA_FUZZER(nanovdb, std::string_view input) {
  std::string content;
  (void)core::find_nanovdb_grid(input, "density", content);
  static const core::test::NanoVdbGridBytes kSound;
  std::string grid = kSound.bytes;
  constexpr std::size_t kChange = 12;
  for (; input.size() >= kChange; input.remove_prefix(kChange)) {
    std::uint32_t offset = 0;
    std::memcpy(&offset, input.data(), sizeof(offset));
    std::memcpy(grid.data() + offset % (grid.size() - 8), input.data() + sizeof(offset), 8);
  }
  constexpr std::uint64_t kMaxVoxels = 4096;
  const auto shape = core::shape_of(grid, kMaxVoxels);
  if (!shape) return expect(!shape.error().message.empty(), "errors have a message");
  expect(shape->voxel_count() <= kMaxVoxels, "the grid is as small as it must be");
  const auto voxels = core::voxels_of(grid, *shape);
  if (!voxels) return expect(!voxels.error().message.empty(), "errors have a message");
  expect(core::is_sound(*voxels), "the grid is sound");
}

}  // namespace tessera::fuzz
