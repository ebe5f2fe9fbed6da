// SPDX-License-Identifier: Apache-2.0
// glTF files, as JSON and in their binary form (load_and_render.hpp).
#include "tests/fuzz/fuzzer.hpp"
#include "tests/fuzz/load_and_render.hpp"

namespace tessera::fuzz {

TESSERA_FUZZER(gltf, std::string_view input) {
  load_and_render(input, "scene.gltf");
}

}  // namespace tessera::fuzz
