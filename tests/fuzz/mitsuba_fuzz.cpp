// SPDX-License-Identifier: Apache-2.0
// Mitsuba scenes (load_and_render.hpp).
#include "tests/fuzz/fuzzer.hpp"
#include "tests/fuzz/load_and_render.hpp"

namespace tessera::fuzz {

TESSERA_FUZZER(mitsuba, std::string_view input) {
  load_and_render(input, "scene.xml");
}

}  // namespace tessera::fuzz
