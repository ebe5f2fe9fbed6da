// SPDX-License-Identifier: Apache-2.0
// Scenes of pbrt, and the files that they include and name (load_and_render.hpp).
#include "tests/fuzz/load_and_render.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  tessera::fuzz::load_and_render(tessera::fuzz::as_text(data, size), "scene.pbrt");
  return 0;
}
