// SPDX-License-Identifier: Apache-2.0
// How fuzzers are declared. With libFuzzer, a program has one; in other builds replay_main.cpp is the main of
// programs that have many, by name: most of the time of compiling one is for headers that others need as
// well.
#pragma once

#include <cstdint>
#include <map>
#include <string_view>

#include "tests/fuzz/parts.hpp"

namespace tessera::fuzz {

using Fuzzer = void (*)(std::string_view input);

// Those of this program.
inline std::map<std::string_view, Fuzzer>& fuzzers() {
  static std::map<std::string_view, Fuzzer> by_name;
  return by_name;
}

}  // namespace tessera::fuzz

// TESSERA_FUZZER(name, std::string_view input) { ... }
#ifdef TESSERA_LIBFUZZER
#define TESSERA_FUZZER(name, parameter)                                               \
  static void name##_fuzzer(parameter);                                               \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) { \
    name##_fuzzer(tessera::fuzz::as_text(data, size));                                \
    return 0;                                                                         \
  }                                                                                   \
  static void name##_fuzzer(parameter)
#else
#define TESSERA_FUZZER(name, parameter)                              \
  static void name##_fuzzer(parameter);                              \
  [[maybe_unused]] static const bool name##_is_known =               \
      tessera::fuzz::fuzzers().emplace(#name, name##_fuzzer).second; \
  static void name##_fuzzer(parameter)
#endif
