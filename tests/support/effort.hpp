// SPDX-License-Identifier: Apache-2.0
// How much a test does of what more of the same would hardly show. A sanitizer makes code ten times as slow,
// and finds errors of memory in a few of many like cases; the optimised build runs all of them.
#pragma once

#include <cstdint>

namespace tessera::test {

#ifdef TESSERA_SANITIZED
inline constexpr std::uint32_t kEffortDivisor = 16;
#else
inline constexpr std::uint32_t kEffortDivisor = 1;
#endif

}  // namespace tessera::test
