// SPDX-License-Identifier: Apache-2.0
// Takes all system calls away from a process, but for those that reading from open files and computing need.
#pragma once

#include "core/sandbox/missing.hpp"

namespace tessera::sandbox {

// From now on this process can allocate memory, use the descriptors that it has, receive more of them, tell
// the time and end. Everything else fails (seccomp(2)): with EPERM; with ENOSYS where the C library then
// tries an older call; and calls that only attacks make, of another architecture or of x32, end the process
// with SIGSYS. Memory cannot be made executable. Call it while there is one thread. The process must not be
// able to gain privileges.
core::Result<Missing> allow_few_system_calls();

}  // namespace tessera::sandbox
