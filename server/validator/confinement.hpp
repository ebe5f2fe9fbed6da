// SPDX-License-Identifier: Apache-2.0
// How a process that reads hostile files gives away what it does not need, so that whoever takes it over has
// little of it: memory and time are bounded, it cannot write, start anything, reach the network, gain rights
// or be traced, and it ends with its parent.
#pragma once

#include <sys/types.h>

#include <cstdint>

#include "core/base/error.hpp"

namespace tessera::validator {

// Sanitizers themselves map terabytes, start processes and trace themselves: their builds keep what that
// takes.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)  // GCC
inline constexpr bool kIsSanitized = true;
#elif defined(__has_feature)  // Clang
inline constexpr bool kIsSanitized = __has_feature(address_sanitizer) || __has_feature(thread_sanitizer);
#else
inline constexpr bool kIsSanitized = false;
#endif

struct Confinement {
  std::uint64_t memory_mib = 16 * 1024;  // address space; beyond it allocations fail
  std::uint64_t cpu_seconds = 300;       // beyond it the kernel ends the process
  pid_t parent = 0;                      // ends with this process; 0: with nobody
};

// For this process, for good. Call it while there is one thread, before anything of others is read.
// What the kernel is too old for is left out; INTERNAL for what should have worked.
core::Status confine(const Confinement& confinement);

}  // namespace tessera::validator
