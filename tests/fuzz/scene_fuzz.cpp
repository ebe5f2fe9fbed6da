// SPDX-License-Identifier: Apache-2.0
// Our own scene files (load_and_render.hpp).
#include "tests/fuzz/fuzzer.hpp"
#include "tests/fuzz/load_and_render.hpp"

namespace tessera::fuzz {

TESSERA_FUZZER(scene, std::string_view input) {
  load_and_render(input, "scene.json");
}

}  // namespace tessera::fuzz
