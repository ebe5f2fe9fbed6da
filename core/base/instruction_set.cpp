// SPDX-License-Identifier: Apache-2.0
#include "core/base/instruction_set.hpp"

namespace tessera::core {

std::string_view instruction_set() {
#ifdef __AVX512F__
  return "x86-64-v4";
#elif defined(__AVX2__)
  return "x86-64-v3";
#else
  return "portable";
#endif
}

}  // namespace tessera::core
