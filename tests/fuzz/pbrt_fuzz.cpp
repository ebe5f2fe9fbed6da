// SPDX-License-Identifier: Apache-2.0
// Scenes of pbrt, and the files that they include and name (load_and_render.hpp).
#include "tests/fuzz/fuzzer.hpp"
#include "tests/fuzz/load_and_render.hpp"

namespace tessera::fuzz {

TESSERA_FUZZER(pbrt, std::string_view input) {
  load_and_render(input, "scene.pbrt");
}

}  // namespace tessera::fuzz
