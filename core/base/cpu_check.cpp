// SPDX-License-Identifier: Apache-2.0
// An executable that links tessera::cpu_check exits with a message if the processor lacks the instructions
// that the rest is compiled for, instead of dying of SIGILL. This file is compiled for any x86-64 and runs
// before other static initialisers. It uses nothing from the C++ library, because template instantiations
// could be merged with ones compiled for newer processors.
#include <unistd.h>

namespace {

[[gnu::constructor(101)]] void require_supported_cpu() {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
      __builtin_cpu_supports("bmi2")) {
    return;
  }
  constexpr char kMessage[] =
      "error: Tessera needs a processor with AVX2, FMA, BMI and BMI2 (Intel since Haswell, AMD since "
      "Excavator), and "
      "this one lacks some of them.\n";
  const ssize_t ignored = ::write(STDERR_FILENO, kMessage, sizeof kMessage - 1);
  static_cast<void>(ignored);
  ::_exit(1);
}

}  // namespace
