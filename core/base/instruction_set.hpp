// SPDX-License-Identifier: Apache-2.0
// Reports which variant of core is running, for performance diagnostics.
#pragma once

#include <string_view>

namespace tessera::core {

// What core is compiled for: "x86-64-v3" (AVX2), "x86-64-v4" (AVX-512) or "portable", any processor.
std::string_view instruction_set();

}  // namespace tessera::core
