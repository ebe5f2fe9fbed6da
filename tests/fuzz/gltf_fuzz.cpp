// SPDX-License-Identifier: Apache-2.0
// glTF files, as JSON and in their binary form (load_and_render.hpp).
#include "tests/fuzz/load_and_render.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  tessera::fuzz::load_and_render(tessera::fuzz::as_text(data, size), "scene.gltf");
  return 0;
}
