// SPDX-License-Identifier: Apache-2.0
// Confines a process that reads untrusted files, so that an exploit gains little: memory and time are
// bounded, and the process cannot write files, start programs, use the network, gain privileges or be traced.
// It ends with its parent.
#pragma once

#include <sys/types.h>

#include <cstdint>

#include "core/base/error.hpp"

namespace tessera::validator {

// Sanitizers map terabytes, start processes and trace themselves, so their builds are confined less.
#ifdef TESSERA_SANITIZED
inline constexpr bool kIsSanitized = true;
#else
inline constexpr bool kIsSanitized = false;
#endif

struct Confinement {
  std::uint64_t memory_mib = 16 * 1024;  // address space; allocations beyond it fail
  std::uint64_t cpu_seconds = 300;       // beyond it, the kernel kills the process
  pid_t parent = 0;                      // the process is killed when this parent ends; 0: none
};

// Confines this process permanently. Call it while there is one thread, before untrusted data is read.
// Features that the kernel lacks are skipped; INTERNAL if a supported one fails.
core::Status confine(const Confinement& confinement);

}  // namespace tessera::validator
