// SPDX-License-Identifier: Apache-2.0
// Confines a process that reads untrusted files, so that an exploit gains little: its memory and time are
// bounded, it is no longer root, and it can only use the descriptors that it has and those that its parent
// sends (file_channel.hpp). It cannot open files, start programs, use the network or be traced, and it ends
// with its parent.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::sandbox {

// Sanitizers map terabytes, start processes and trace themselves, so their builds are confined less.
#ifdef TESSERA_SANITIZED
inline constexpr bool kIsSanitized = true;
#else
inline constexpr bool kIsSanitized = false;
#endif

struct Confinement {
  std::uint64_t memory_mib = 16 * 1024;  // address space; allocations beyond it fail
  std::uint64_t cpu_seconds = 300;       // beyond it, the kernel kills the process
  std::uint64_t output_bytes = 1 << 20;  // of each file that it writes to
  pid_t parent = 0;                      // the process is killed when this parent ends; 0: none
  bool complete = false;                 // fail if a part is missing
};

// Confines this process permanently. Call it while there is one thread, before untrusted data is read. Closes
// all descriptors but the standard ones and the file channel. Returns what the kernel, the container or the
// build lacks of the sandbox: sentences, none if it is complete. FAILED_PRECONDITION if that is not accepted;
// INTERNAL if a supported call fails; UNAVAILABLE if the parent has ended.
core::Result<std::vector<std::string>> confine(const Confinement& confinement);

}  // namespace tessera::sandbox
