// SPDX-License-Identifier: Apache-2.0
// Which of its variants core is, for those who ask why one machine is faster than another.
#pragma once

#include <string_view>

namespace tessera::core {

// The level of x86-64 that the functions of core are compiled for: "x86-64-v3" (AVX2) or "x86-64-v4" (AVX-512).
std::string_view instruction_set();

}  // namespace tessera::core
